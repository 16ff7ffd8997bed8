# Error over time of every setting: all frames at once, and frame by frame.
load here."/style.gp"
set logscale xy
set xlabel "time of 120 frames [s]"
set ylabel "RMSE / mean B [%]"
set key outside top center horizontal
ladder = bench."/ladder.csv"
alone = bench."/alone.csv"
plot ladder using "seconds":"rmse_percent" with points ls 9 title "all frames at once", \
     ladder using "seconds":"rmse_moving_percent" with points ls 10 title "the same, moving patches", \
     alone using "seconds":"rmse_percent" with linespoints ls 1 title "frame by frame"
