#include <cmath>
#include <functional>
#include <span>

#include "engine/bench/bench_report.h"
#include "engine/bench/bench_text.h"
#include "engine/bench/machine.h"
#include "engine/bench/paper_results.h"

namespace engine {
namespace {

/// "-" for what [P] does not report.
std::string or_dash(double value, const std::string& text) {
  return value == 0 ? "-" : text;
}

/// A column of a table: [P]'s where there is one, and ours.
struct Column {
  const char* heading;
  const PaperColumn* paper;
  const RunResult* ours;
};

struct Row {
  const char* name;
  std::function<std::string(const PaperColumn&)> paper;
  std::function<std::string(const RunResult&)> ours;
};

std::string frames_text(const RunResult& result) {
  std::size_t checks = 0;
  for (const api::FrameRecord& frame : result.run.key_frames.frames)
    checks += frame.kind == api::FrameKind::check;
  const std::size_t solved = solved_frames(result.run.key_frames);
  return checks == 0 ? std::to_string(solved) : text_of("%zu + %zu checks", solved - checks, checks);
}

double relative_rmse(const SequenceError& error) {
  return error.rmse_average_w_m2 / error.mean_radiosity_w_m2;
}

const std::vector<Row>& rows() {
  using P = PaperColumn;
  using R = RunResult;
  static const std::vector<Row> kRows{
      {"key-frames", [](const P& p) { return std::to_string(p.key_frames); }, frames_text},
      {"estimation", [](const P& p) { return or_dash(p.estimation_s, text_of("%.0f s", p.estimation_s)); },
       [](const R& r) { return text_of("%.2f s", r.run.estimation_s); }},
      {"computation",
       [](const P& p) { return or_dash(p.computation_min, text_of("%.0f min", p.computation_min)); },
       [](const R& r) { return text_of("%.2f s", r.run.computation_s); }},
      {"per frame", [](const P& p) { return text_of("%.0f s", p.per_frame_s); },
       [](const R& r) { return text_of("%.1f ms", 1e3 * r.seconds() / kBenchFrames); }},
      {"absolute speed-up", [](const P& p) { return text_of("%.3g", p.absolute_speed_up); },
       [](const R& r) { return text_of("%.1f", r.absolute_speed_up); }},
      {"relative speed-up", [](const P& p) { return text_of("%.3g", p.relative_speed_up); },
       [](const R& r) { return text_of("%.2f", r.relative_speed_up); }},
      {"memory", [](const P& p) { return or_dash(p.memory_mb, text_of("%.0f MB", p.memory_mb)); },
       [](const R& r) { return text_of("%.0f MB", static_cast<double>(r.run.peak_memory_bytes) / 1e6); }},
      {"RMSE average", [](const P& p) { return or_dash(p.rmse_average, text_of("%.1e", p.rmse_average)); },
       [](const R& r) { return text_of("%.1e W/m²", r.error.rmse_average_w_m2); }},
      {"the same / mean B", [](const P&) { return std::string("-"); },
       [](const R& r) { return text_of("%.2f %%", 100 * relative_rmse(r.error)); }},
      {"largest error", [](const P&) { return std::string("-"); },
       [](const R& r) { return text_of("%.0f %%", 100 * r.error.largest); }},
      {"beyond 5 %", [](const P&) { return std::string("-"); },
       [](const R& r) { return text_of("%.3f %%", 100 * r.error.share_beyond); }},
  };
  return kRows;
}

std::string table_cell(const std::string& text) {
  return std::string(1, ' ').append(text).append(" |");
}

/// Nothing while a column is missing.
std::string table(const char* title, std::span<const Column> columns) {
  for (const Column& column : columns)
    if (!column.ours) return {};
  std::string text = text_of("## %s\n\n| |", title), line = "|---|";
  for (const Column& column : columns) {
    const std::string heading = column.heading;
    if (column.paper) text += table_cell(std::string("[P] ").append(heading));
    text += table_cell(column.paper ? std::string("ours, ").append(heading) : heading);
    line += column.paper ? "---|---|" : "---|";
  }
  text.append(1, '\n').append(line).append(1, '\n');
  for (const Row& row : rows()) {
    text.append(1, '|').append(table_cell(row.name));
    for (const Column& column : columns) {
      if (column.paper) text += table_cell(row.paper(*column.paper));
      text += table_cell(row.ours(*column.ours));
    }
    text += "\n";
  }
  return text + "\n";
}

using Groups = std::vector<GroupResult>;

std::string paper_tables(const Groups& groups) {
  const auto run = [&](const char* name) { return find_run(groups, name); };
  std::string text;
  text += table("The garage ([P] Table 2)",
                std::vector<Column>{{"ε .1", &kPaperTable2[0], run(kPaperTable2[0].run)},
                                    {"ε .2", &kPaperTable2[1], run(kPaperTable2[1].run)},
                                    {"full", &kPaperTable2[2], run(kPaperTable2[2].run)},
                                    {"our default", nullptr, run("garage_default")}});
  text += table("The garage with its middle lamp off ([P] Table 3)",
                std::vector<Column>{{"ε .1", &kPaperTable3[0], run(kPaperTable3[0].run)},
                                    {"full", &kPaperTable3[1], run(kPaperTable3[1].run)},
                                    {"our default", nullptr, run("garage_off_default")}});
  text += table("The office ([P]'s third scene)",
                std::vector<Column>{{"ε .05", &kPaperOffice[0], run(kPaperOffice[0].run)},
                                    {"full", nullptr, run("office_full")},
                                    {"our default", nullptr, run("office_default")}});
  return text;
}

/// Equation (1) and the straight line of equation (2), run by run.
std::string cost_table(const GroupResult& group) {
  std::string text =
      text_of("| %s", group.name.c_str()) +
      " | frames solved k | measured C(k) | N (a + b k) | off | estimate C(K, N_est) | (1): C_tot |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const RunResult& result : group.runs) {
    if (result.run.key_frames.mode == api::LightingMode::standard) continue;
    const auto k = static_cast<double>(solved_frames(result.run.key_frames));
    const double fitted = group.cost.seconds(k), measured = result.run.computation_s;
    text += text_of("| %s", result.run.name.c_str()) +
            text_of(" | %.0f | %.2f s | %.2f s | %+.0f %% | %.2f s | %.2f s |\n", k, measured, fitted,
                    100 * (fitted - measured) / measured, result.run.estimation_s,
                    fitted + result.run.estimation_s);
  }
  return text + "\n";
}

std::string cost_words(const GroupResult& group) {
  const CostFit& fit = group.cost;
  const BenchRun& full = group.runs[0].run;
  const double lines = count_of(full.report, "lines");
  const double touched = count_of(full.report, "lines_touched_by_moving_objects");
  std::string text = text_of(
      "a = %.0f ns and b = %.1f ns per line and frame, N = %.3g; root mean square deviation "
      "%.1f %%.\n",
      1e9 * fit.once_s / group.lines, 1e9 * fit.per_frame_s / group.lines, group.lines, 100 * fit.deviation);
  text += text_of("Solving fewer frames can gain %.1f times at most, C(K) / (N a).\n",
                  fit.largest_speed_up(kBenchFrames));
  text += text_of("What equation (2) is made of: n_s = %zu, n_d = %zu, A = %.0f m², A_d = %.0f m²; ",
                  group.numbers.static_polygons, group.numbers.moving_polygons, group.numbers.box_m2,
                  group.numbers.motion_m2);
  text += text_of(
      "n_is = %.2f hits per line; %.1f %% of the %.3g lines meet something that moves, "
      "A_d / A = %.1f %%.\n\n",
      lines > 0 ? count_of(full.report, "static_hits") / lines : 0.0, lines > 0 ? 100 * touched / lines : 0.0,
      lines, 100 * group.numbers.motion_m2 / group.numbers.box_m2);
  return text;
}

std::string cost_section(const Groups& groups) {
  std::vector<CostPoint> papers;
  for (const PaperColumn& column : kPaperTable2)
    papers.push_back({static_cast<double>(column.key_frames), 60 * column.computation_min});
  const CostFit paper = fit_cost(papers);
  std::string text =
      "## Cost against [P]'s equations\n\n"
      "(1) C_tot = C(K, N_est) + C(k, N_full). (2), times k and with its log k taken as constant, is the "
      "straight "
      "line C(k) = N (a + b k).\n";
  text += text_of("[P]'s Table 2 gives %.1f min once and %.2f min per key-frame: %.1f times at most.\n\n",
                  paper.once_s / 60, paper.per_frame_s / 60, paper.largest_speed_up(kBenchFrames));
  for (const GroupResult& group : groups) {
    if (group.cost.per_frame_s == 0) continue;  // too few runs of different k
    text += cost_table(group) + cost_words(group);
  }
  return text;
}

}  // namespace

std::string bench_markdown(const Groups& groups, const BenchOptions& options, double load) {
  std::string text = "# Keylume and the paper it follows\n\n";
  if (options.quick) text += "**Quick: large patches and few lines. Nothing here is to be quoted.**\n\n";
  if (load > kIdleLoad)
    text += text_of(
        "**Other programs were at work (load %.1f per core): times are too long, and their ratios "
        "rough.**\n\n",
        load);
  text +=
      "[P]: Besuievsky & Pueyo, *A Monte Carlo Method for Accelerating the Computation of Animated Radiosity "
      "Sequences*; their times are of a Pentium III at 450 MHz. Ours are medians where a run takes less than "
      "a "
      "minute. 120 frames each. Absolute speed-up: against the same kernels, lines and patches frame by "
      "frame (";
  for (const GroupResult& group : groups)
    text += text_of("%s%s %.0f s", &group == &groups[0] ? "" : ", ", group.name.c_str(), group.alone_s);
  text += text_of(
      ", from %zu frames run so, times %u / %zu). Relative: against all frames solved at once. RMSE and "
      "errors: of "
      "the interpolation, against all frames solved with the same lines; patches that emit are left out; "
      "error = max |B^ - B| / max(B, half the mean B) over channels.\n\n",
      solved_frames(groups[0].alone.key_frames), kBenchFrames, solved_frames(groups[0].alone.key_frames));
  return text + paper_tables(groups) + cost_section(groups);
}

}  // namespace engine
