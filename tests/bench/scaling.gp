# One curve of `bench scaling`: time and memory over the size of what is varied. Jobs that were refused have no point.
load here."/style.gp"
set logscale xy
set xlabel curve
set ylabel "time [s]"
set y2label "peak memory [MB]"
set logscale y2
set y2tics
set border 11 lc rgb "#606060"
set key outside top center horizontal
set offsets graph 0.05, graph 0.05, graph 0.1, graph 0.1
number(key) = strcol(key) eq "-" ? NaN : column(key)
points = bench."/".curve.".csv"
plot points using curve:(number("seconds")) with linespoints ls 1 title "time", \
     points using curve:(number("direct_s")) with linespoints ls 2 title "of it direct light", \
     points using curve:(number("memory_mb")) axes x1y2 with linespoints ls 3 title "peak memory"
