# Figure 9: four frames of the office, interpolated between the key-frames of Table 1 at .05.
frames = "20 50 75 105"
runs = "office_eps_0.05 office_eps_0.05"
titles = ""
columns = 2; rows = 2
load here."/sheet.gp"
