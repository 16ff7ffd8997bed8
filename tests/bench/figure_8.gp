# Figure 8: frames 10, 31, 84 and 111 (counted from 1) of the garage: all solved, Table 1 at .1, and at .2.
frames = "10 31 84 111"
runs = "garage_full garage_eps_0.1 garage_eps_0.2"
titles = "'all frames solved' 'threshold .1' 'threshold .2'"
columns = 3; rows = 4
load here."/sheet.gp"
