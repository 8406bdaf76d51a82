#include "apps/common/report.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "apps/common/markup.h"
#include "apps/common/version.h"

namespace surefoot::apps {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, "Segoe UI", Helvetica, Arial, sans-serif; color: #262b33;
       max-width: 1060px; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; margin: 0; } h2 { font-size: 1.1rem; margin: 2.2rem 0 .6rem; }
.verdict { display: inline-block; padding: .1rem .7rem; border-radius: 1rem; color: white; }
.good { background: #00855f; } .bad { background: #b8472a; }
.sub { color: #70777f; margin: .2rem 0 1.2rem; }
.figures { display: grid; gap: .7rem; margin-bottom: 1.5rem;
       grid-template-columns: repeat(auto-fill, minmax(165px, 1fr)); }
.figures div { border: 1px solid #e4e7eb; border-radius: .5rem; padding: .5rem .8rem; }
.figures b { display: block; font-size: 1.15rem; font-weight: 600; }
.figures span { color: #70777f; font-size: .85rem; }
table { border-collapse: collapse; } td, th { padding: .25rem .8rem; text-align: right;
       border-bottom: 1px solid #e4e7eb; } td:first-child, th:first-child { text-align: left; }
figure { margin: 1.6rem 0; } figcaption { color: #70777f; font-size: .9rem; } svg { width: 100%; }
pre { background: #f6f7f9; padding: 1rem; overflow-x: auto; font-size: .8rem; }
)";

bool write_file(const std::filesystem::path& path, const char* data, std::size_t size,
                std::string& problem) {
  std::ofstream file(path, std::ios::binary);
  file.write(data, static_cast<std::streamsize>(size));
  file.close();
  if (file) return true;
  problem = fmt::format("{}: {}", path.string(), std::strerror(errno));
  return false;
}

std::string figure(const std::string& value, const std::string& name) {
  return fmt::format("<div><b>{}</b><span>{}</span></div>\n", escaped(value), escaped(name));
}

std::string key_figures(const RunFacts& facts) {
  const RunMeasures& m = facts.measures;
  const double factor = facts.wall_time_s > 0 ? facts.sim_time_s / facts.wall_time_s : 0;
  std::string html = "<div class=\"figures\">\n";
  html += figure(fmt::format("{:.2f} m/s", m.mean_speed_m_s), "mean speed towards the goal");
  html += figure(fmt::format("{:.2f} m", m.start_to_goal_m), "from start to goal");
  html += figure(fmt::format("{:.1f} s", m.walk_s), "walking");
  html += figure(fmt::format("{:.2f} %", m.estimate.drift_percent), "drift of the estimate");
  html += figure(fmt::format("{:.1f} mm", 1000 * m.estimate.rms_error_m), "estimate, rms error");
  html += figure(fmt::format("{:.1f} mm", 1000 * facts.map.rmse_m), "map, rms error");
  html +=
      figure(fmt::format("{:.0f} %", 100 * facts.map.known_fraction), "of the way was measured");
  html += figure(fmt::format("{:.3f} m", facts.terrain.max_step_m), "tallest step of the ground");
  html += figure(fmt::format("{} / {}", m.foot_slips, m.collisions), "foot slips / body touches");
  html += figure(fmt::format("{:.1f} x", factor), "faster than real time");
  html += figure(fmt::format("{} / {}", facts.heap_calls, facts.page_faults),
                 "heap calls / page faults after start-up");
  html += figure(fmt::format("{:.1f} MB", static_cast<double>(facts.static_bytes) / 1e6),
                 "static memory of the autonomy");
  return html + "</div>\n";
}

std::string task_table(const RunFacts& facts) {
  std::string html =
      "<table><tr><th>task</th><th>period</th><th>budget</th><th>runs</th><th>median</th>"
      "<th>99 %</th><th>maximum</th><th>over budget</th></tr>\n";
  for (const runtime::TaskReport& task : facts.tasks) {
    html += fmt::format(
        "<tr><td>{}</td><td>{} us</td><td>{} us</td><td>{}</td><td>{:.0f} us</td><td>{:.0f} us</td>"
        "<td>{:.0f} us</td><td>{}</td></tr>\n",
        task.name, task.period_us, task.budget_us, task.count, task.p50_us, task.p99_us,
        task.max_us, task.overruns);
  }
  return html + "</table>\n";
}

std::string page(const RunFacts& facts, const std::vector<NamedDrawing>& drawings,
                 const std::string& config_text) {
  const bool good = facts.verdict.outcome == Outcome::kGoal;
  std::string html = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n";
  html += fmt::format("<title>{} on {}, seed {}</title>\n", escaped(facts.request.robot),
                      escaped(facts.request.world), facts.request.seed);
  html += fmt::format("<style>{}</style></head><body>\n", kStyle);
  html += fmt::format("<h1>{} on {} <span class=\"verdict {}\">{}</span></h1>\n",
                      escaped(facts.request.robot), escaped(facts.request.world),
                      good ? "good" : "bad", to_string(facts.verdict.outcome));
  html += fmt::format(
      "<p class=\"sub\">{}. Mission {}, seed {}, {:.1f} s simulated, {} ticks, hash {}, "
      "configuration {}, version {}.</p>\n",
      escaped(facts.verdict.reason), escaped(facts.request.mission), facts.request.seed,
      facts.sim_time_s, facts.ticks, hex16(facts.hash), hex16(facts.config_hash),
      escaped(version_text()));
  html += key_figures(facts);
  for (const NamedDrawing& item : drawings) {
    html += fmt::format("<figure id=\"{}\">{}<figcaption>{}</figcaption></figure>\n", item.name,
                        to_svg(item.drawing), escaped(item.caption));
  }
  html += "<h2>Tasks</h2>\n" + task_table(facts);
  html += fmt::format(
      "<h2>Configuration</h2><details><summary>every value of this run</summary>"
      "<pre>{}</pre></details>\n",
      escaped(config_text));
  return html + "</body></html>\n";
}

}  // namespace

bool write_report(const std::filesystem::path& folder, const RunFacts& facts,
                  const std::vector<NamedDrawing>& drawings, const std::string& config_text,
                  std::string& problem) {
  for (const NamedDrawing& item : drawings) {
    const std::vector<std::uint8_t> png = to_png(item.drawing);
    if (!write_file(folder / (item.name + ".png"), reinterpret_cast<const char*>(png.data()),
                    png.size(), problem)) {
      return false;
    }
  }
  const std::string html = page(facts, drawings, config_text);
  return write_file(folder / "report.html", html.data(), html.size(), problem);
}

}  // namespace surefoot::apps
