# A sheet of pictures: `rows` by `columns`, each 400 x 225 pixels, one to one. A column per run where there are
# titles, else the frames one after the other.
wide = 400; high = 225; gap = 6; head = strlen(titles) ? 26 : 0; foot = 20
width = columns * (wide + gap) - gap
height = rows * (high + foot) + head
set terminal pngcairo size width, height font "sans,11"
set output out.".png"
unset border; unset tics; unset key; unset colorbox
set multiplot
do for [row = 0 : rows - 1] { do for [column = 0 : columns - 1] {
  frame = int(word(frames, strlen(titles) ? row + 1 : row * columns + column + 1))
  picture = sprintf("%s/jobs/%s/artefacts/images/main/%04d.png", bench, word(runs, column + 1), frame - 1)
  left = column * (wide + gap); top = height - head - row * (high + foot)
  set lmargin at screen 1.0 * left / width
  set rmargin at screen 1.0 * (left + wide) / width
  set tmargin at screen 1.0 * top / height
  set bmargin at screen 1.0 * (top - high) / height
  unset label
  if (row == 0 && strlen(titles)) {
    set label 1 word(titles, column + 1) at graph 0.5, screen 1.0 - 13.0 / height center
  }
  set label 2 sprintf("frame %d", frame) at graph 0.5, screen 1.0 * (top - high - 10) / height center
  plot [0:wide] [0:high] picture binary filetype=png origin=(0.5, 0.5) with rgbimage
} }
unset multiplot
