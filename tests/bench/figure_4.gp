# Figure 4: radiosity of three patches of the room over time, and the frames that the default solves.
load here."/style.gp"
set xlabel "frame"
set ylabel "radiosity [W/m²]"
set xrange [1:120]
set yrange [0:*]
set key outside top center horizontal
probes = bench."/probes.csv"
keys = bench."/key_frames.csv"
solved(run, kind) = stringcolumn(1) eq run && stringcolumn(3) eq kind ? column(2) : NaN
plot probes using 1:2 with lines ls 1 title "top of the red cube", \
     probes using 1:3 with lines ls 2 title "front of the green cube", \
     probes using 1:4 with lines ls 3 title "top of the wing", \
     keys using (solved("room_default", "key")):(0) with impulses ls 9 notitle, \
     keys using (solved("room_default", "key")):(graph_low) with points ls 9 title "key-frame", \
     keys using (solved("room_default", "check")):(graph_low) with points ls 10 title "check frame"
