# Lines and letters of the plots. `kind`: svg or png.
set datafile separator ","
set datafile missing NaN
if (kind eq "svg") { set terminal svg size 800,360 dynamic font "sans,12" background "white" } \
else { set terminal pngcairo size 1000,450 font "sans,12" background "white" }
set output out.".".kind
set border 3 lc rgb "#606060"
set tics nomirror
set grid ytics lc rgb "#e0e0e0"
set style line 1 lc rgb "#c0392b" lw 2
set style line 2 lc rgb "#1e8449" lw 2
set style line 3 lc rgb "#2e6da4" lw 2
set style line 9 lc rgb "#303030" pt 7 ps 0.5
set style line 10 lc rgb "#303030" pt 6 ps 0.5
graph_low = 0
