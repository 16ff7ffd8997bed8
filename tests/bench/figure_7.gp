# Figure 7: root mean square error of each frame of the garage, against all frames solved.
load here."/style.gp"
set xlabel "frame"
set ylabel "RMSE [10⁻³ W/m²]"
set xrange [1:120]
set yrange [0:*]
set key outside top center horizontal
errors = bench."/rmse.csv"
plot errors using "frame":(1e3 * column("garage_eps_0.2")) with lines ls 3 title "ε = .2", \
     errors using "frame":(1e3 * column("garage_eps_0.1")) with lines ls 1 title "ε = .1", \
     errors using "frame":(1e3 * column("garage_default")) with lines ls 2 title "default, 5 %"
