/// cooperation: "Simulator for cooperation and competition of mobile robots". Its experiment of section 4, with and without the
/// disturbing robot and the radio, on both engines; the competition of predator and prey and the cooperation of carriers, which
/// its introduction describes.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "app/papers/papers.h"
#include "draw/interval_plot.h"
#include "draw/plot.h"

namespace sandlot::app {
namespace {

using draw::IntervalRow;

struct Measured {
  Condition condition;
  RepeatSummary runs;
};

Result<std::vector<Measured>> measure(const ReproduceContext& context,
                                      const std::vector<Condition>& conditions) {
  std::vector<Measured> out;
  for (const Condition& condition : conditions) {
    SL_ASSIGN(RepeatSummary runs, context.runs(condition));
    out.push_back({condition, std::move(runs)});
  }
  return out;
}

Status write_csv(const ReproduceContext& context, const std::string& name, const std::vector<Measured>& all) {
  std::vector<std::pair<std::string, const RepeatSummary*>> named;
  for (const Measured& each : all) named.emplace_back(each.condition.name, &each.runs);
  return context.write(name, csv_of(named));
}

std::optional<SuccessRate> success(const RepeatSummary& runs) {
  return runs.all ? runs.all->success : std::nullopt;
}

IntervalRow rate_row(const std::string& label, const RepeatSummary& runs, int colour) {
  const auto rate = success(runs);
  if (!rate || !rate->rate) return {label, {}, {}, {}, colour};
  return {label, 100 * *rate->rate, 100 * rate->low.value_or(0), 100 * rate->high.value_or(1), colour};
}

IntervalRow estimate_row(const std::string& label, const Estimate& e, int colour) {
  return {label, e.mean, e.low, e.high, colour};
}

std::vector<std::string> cells(const Measured& each) {
  const RepeatSummary& runs = each.runs;
  const auto rate = success(runs);
  const Estimate criterion = runs.all ? runs.all->criterion : Estimate();
  const auto number = [](const std::optional<double>& x) { return x ? fmt::format("{:.3g}", *x) : "-"; };
  return {each.condition.name,         rate ? text_of(*rate) : "-", text_of(criterion),
          number(criterion.deviation), text_of(runs.end_s, 4),      number(runs.end_s.deviation)};
}

const std::vector<std::string> names{
    "condition",     "success, Wilson's interval",           "criterion, mean and Student's interval",
    "its deviation", "end [s], mean and Student's interval", "its deviation"};

bool apart(const SuccessRate& a, const SuccessRate& b) {
  return a.low && b.high && b.low && a.high && (*a.low > *b.high || *b.low > *a.high);
}

bool apart(const Estimate& a, const Estimate& b) {
  return a.low && b.high && b.low && a.high && (*a.low > *b.high || *b.low > *a.high);
}

std::string compared(const RepeatSummary& a, const RepeatSummary& b) {
  const auto x = success(a), y = success(b);
  if (!x || !y) return "no run has a value";
  return fmt::format("{:.1f} % against {:.1f} %; the intervals {}", 100 * x->rate.value_or(0),
                     100 * y->rate.value_or(0), apart(*x, *y) ? "do not overlap" : "overlap");
}

// --- section 4: clearing ---

std::vector<Condition> clearing_conditions() {
  std::vector<Condition> out;
  for (const std::string engine : {"planar", "rigid"})
    for (const bool disturber : {false, true})
      for (const bool radio : {true, false})
        out.push_back({engine + (disturber ? ", disturber" : "") + (radio ? ", radio" : ", no radio"),
                       "clearing",
                       {{"physics", engine},
                        {"disturbers", disturber ? "1" : "0"},
                        {"radio", radio ? "true" : "false"}}});
  return out;
}

Status clearing(const ReproduceContext& context, ReportPage& page) {
  SL_ASSIGN(const std::vector<Measured> all, measure(context, clearing_conditions()));
  SL_TRY(write_csv(context, "clearing.csv", all));
  page.heading("Section 4: clearing an area");
  page.paragraph(
      "Two robots with a blade push six boxes, placed at random, into a disc. They see all by one camera "
      "above the yard. Criterion: "
      "the share of boxes inside; a run succeeds when all are inside within 90 s. All conditions "
      "have the same seeds, so that "
      "boxes and robots begin in the same places.");
  SL_ASSIGN(const std::string begin, context.drawing(all[0].condition, 30));
  page.figure(begin, "The first seed after 30 s on the planar engine, with the ways of the robots.");
  page.table(names, [&] {
    std::vector<std::vector<std::string>> rows;
    for (const Measured& each : all) rows.push_back(cells(each));
    return rows;
  }());
  std::vector<IntervalRow> rates, times;
  for (const Measured& each : all) {
    const int colour = each.runs.physics == "planar" ? 0 : 1;
    rates.push_back(rate_row(each.condition.name, each.runs, colour));
    times.push_back(estimate_row(each.condition.name, each.runs.end_s, colour));
  }
  page.figure(
      draw::draw_intervals(
          rates,
          {.title = "Runs in which all boxes are inside", .x_label = "%", .range = {{0, 100}}, .mark = {}}),
      "Rates with Wilson's 95 % intervals.");
  page.figure(
      draw::draw_intervals(
          times, {.title = "Time until all are inside, or the end", .x_label = "s", .range = {}, .mark = {}}),
      "Means with Student's 95 % intervals.");
  // Pairs of conditions that differ in one thing: index of the one, index of the other.
  struct Pair {
    const char* what;
    std::size_t a, b;
  };
  constexpr std::array<Pair, 6> pairs{{{"disturber, planar, radio", 0, 2},
                                       {"disturber, rigid, radio", 4, 6},
                                       {"no radio, planar", 0, 1},
                                       {"no radio, planar, disturber", 2, 3},
                                       {"no radio, rigid", 4, 5},
                                       {"no radio, rigid, disturber", 6, 7}}};
  std::vector<std::vector<std::string>> rows;
  std::vector<IntervalRow> differences;
  for (const Pair& pair : pairs) {
    const auto by = [&](const auto& figure) {
      return paired_difference(all[pair.a].runs, all[pair.b].runs, figure);
    };
    const Estimate share = by([](const RepeatedRun& run) { return run.criterion; });
    const Estimate end = by([](const RepeatedRun& run) { return std::optional<double>(run.end_s); });
    rows.push_back({pair.what, text_of(share), text_of(end)});
    differences.push_back(estimate_row(pair.what, end, static_cast<int>(&pair - pairs.data()) < 2 ? 2 : 3));
  }
  page.paragraph("Differences run by run, each with the run of the same seed in the other condition:");
  page.table({"difference by", "share of boxes inside", "time [s]"}, rows);
  page.figure(
      draw::draw_intervals(differences, {.title = "Longer by", .x_label = "s", .range = {}, .mark = 0.0}),
      "Mean differences of the time with Student's 95 % intervals; 0: none.");
  page.table(
      {"the paper", "here"},
      {{"Two robots that push, steered by a camera above, move all scattered objects into the area (it gives "
        "no numbers).",
        fmt::format("planar: {}; rigid: {}", success(all[0].runs) ? text_of(*success(all[0].runs)) : "-",
                    success(all[4].runs) ? text_of(*success(all[4].runs)) : "-")},
       {"A perturbing robot makes things harder for them.",
        "planar: " + compared(all[0].runs, all[2].runs) + "; rigid: " + compared(all[4].runs, all[6].runs)},
       {"A radio channel enables communication between the two robots.",
        "without it, planar: " + compared(all[0].runs, all[1].runs) + "; time longer by " + rows[2][2] +
            " s"}});
  return {};
}

/// Where the energy of a pusher goes (section 4), and what a step costs (section 3).
Status energy_and_time(const ReproduceContext& context, ReportPage& page) {
  constexpr double receiver_w = 0.2, emitter_j = 0.005, drive_j = 0.05;  // scenarios/clearing.yaml
  struct Run {
    double end_s = 0, camera = 0, drive = 0, radio = 0;
  };
  std::array<Run, 2> ends;
  std::vector<draw::Table> tables;
  for (const bool radio : {true, false}) {
    SL_ASSIGN(
        const LoggedRun run,
        context.logged({.condition = {radio ? "energy" : "energy, no radio",
                                      "clearing",
                                      {{"radio", radio ? "true" : "false"}}},
                        .values = {"pusher1/camera.drawn", "pusher1/drive.drawn", "pusher1/radio.drawn"},
                        .rate_hz = 10}));
    const auto last = [&](std::size_t column) { return run.values.columns[column].back(); };
    if (run.values.columns.size() != 4 || run.values.columns[0].empty())
      return Error{"clearing has logged nothing"};
    ends[radio ? 0 : 1] = {last(0), last(1), last(2), last(3)};
    if (radio) tables.push_back(run.values);
  }
  page.paragraph(
      "Energy. The paper: the camera consumes no power, since it is not mounted on the robot; propulsion and "
      "radio "
      "emitter consume at each activation; the receiver drains continuously. One pusher of the first seed, "
      "on the "
      "planar engine:");
  SL_ASSIGN(const std::string figure,
            draw::draw_plot(tables, {.x_label = "time [s]",
                                     .y_label = "energy drawn by pusher1 [J]",
                                     .labels = {"camera", "propulsion", "radio, emitter and receiver"}}));
  page.figure(figure,
              "Energy that each device of a pusher has drawn from its battery, with radio. A use of the "
              "radio is counted "
              "with each of its samples, sent or not: in this the paper's emitter, which consumes when it "
              "sends, differs.");
  const auto joules = [](double x) { return fmt::format("{:.1f} J", x); };
  const Run &with = ends[0], &without = ends[1];
  page.table(
      {"", fmt::format("with radio, {:.1f} s", with.end_s), fmt::format("without, {:.1f} s", without.end_s),
       "by hand"},
      {{"camera", joules(with.camera), joules(without.camera), "0"},
       {"receiver", joules(receiver_w * with.end_s), joules(receiver_w * without.end_s),
        fmt::format("{:g} W all the time, from the run's length", receiver_w)},
       {"emitter", joules(with.radio - receiver_w * with.end_s),
        joules(without.radio - receiver_w * without.end_s),
        fmt::format(
            "the radio's rest: {:.0f} and {:.0f} times {:g} mJ, 20 a second also where nothing is sent",
            (with.radio - receiver_w * with.end_s) / emitter_j,
            (without.radio - receiver_w * without.end_s) / emitter_j, 1000 * emitter_j)},
       {"propulsion", joules(with.drive), joules(without.drive),
        fmt::format("{:.1f} and {:.1f} J by {:g} mJ for each of 20 commands a second; the rest is work",
                    20 * drive_j * with.end_s, 20 * drive_j * without.end_s, 1000 * drive_j)}});
  SL_ASSIGN(const std::vector<StepTime> steps,
            context.step_times({"step_times", "clearing", {}}, 20, std::nullopt));
  statistics::Sample ms;
  for (const StepTime& step : steps) ms.add(1000 * step.compute_s);
  page.paragraph(
      fmt::format("Time. The paper: steps of 10 ms are enough for all calculations, and drawing costs two or "
                  "three orders of "
                  "magnitude more than simulating. Here a step of 10 ms of the same run takes {:.3f} ms on "
                  "average on this machine "
                  "({:.2f} ms at most), and nothing is drawn in it: pages draw in the browser, and drawings "
                  "such as those above "
                  "are made after a run. Wall times differ from run to run.",
                  ms.mean(), ms.max()));
  return {};
}

// --- section 1: predator and prey ---

Status predator_prey(const ReproduceContext& context, ReportPage& page) {
  constexpr std::array<const char*, 3> hunts{"pursuit", "lead", "encircle"},
      escapes{"flee", "zigzag", "hide"};
  std::vector<Condition> conditions;
  for (const std::string hunt : hunts)
    for (const std::string escape : escapes)
      conditions.push_back({hunt + " / " + escape, "predator_prey", {{"hunt", hunt}, {"escape", escape}}});
  SL_ASSIGN(const std::vector<Measured> all, measure(context, conditions));
  SL_TRY(write_csv(context, "predator_prey.csv", all));
  page.heading("Section 1: predator and prey");
  page.paragraph(
      "Three predators hunt a prey that is a quarter faster than they are, in a walled yard of 6 m by 6 m, "
      "for a minute at most. A run "
      "succeeds for the predators when one comes within 22 cm. Strategies: predators / prey.");
  SL_ASSIGN(const std::string drawing, context.drawing(all[6].condition, 10));
  page.figure(drawing, "Predators that encircle a prey that flees: the first seed until the catch, or 10 s.");
  std::vector<std::vector<std::string>> rows;
  std::vector<IntervalRow> rates;
  for (std::size_t i = 0; i < all.size(); ++i) {
    rows.push_back(cells(all[i]));
    rates.push_back(rate_row(all[i].condition.name, all[i].runs, static_cast<int>(i / 3)));
  }
  page.table(names, rows);
  page.figure(
      draw::draw_intervals(
          rates,
          {.title = "Runs in which the prey is caught", .x_label = "%", .range = {{0, 100}}, .mark = {}}),
      "Rates with Wilson's 95 % intervals; one colour per strategy of the predators.");
  // Each strategy over all of the other side, by the time until the catch or the end.
  const auto pooled = [&](std::size_t first, std::size_t step) {
    statistics::Sample times;
    for (std::size_t k = 0; k < 3; ++k)
      for (const RepeatedRun& run : all[first + k * step].runs.runs)
        if (run.errors.empty()) times.add(run.end_s);
    return estimate_of(times);
  };
  const auto ranking = [&](const char* side, const auto& strategies, bool predators) {
    struct Entry {
      std::string name;
      Estimate time;
    };
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < 3; ++i)
      entries.push_back({strategies[i], predators ? pooled(3 * i, 1) : pooled(i, 3)});
    std::stable_sort(entries.begin(), entries.end(), [&](const Entry& a, const Entry& b) {
      const double x = a.time.mean.value_or(0), y = b.time.mean.value_or(0);
      return predators ? x < y : x > y;
    });
    std::vector<std::vector<std::string>> ranked;
    std::vector<IntervalRow> drawn;
    for (std::size_t i = 0; i < entries.size(); ++i) {
      const bool last = i + 1 == entries.size();
      ranked.push_back({fmt::format("{}", i + 1), entries[i].name, text_of(entries[i].time),
                        last                                          ? ""
                        : apart(entries[i].time, entries[i + 1].time) ? "the intervals do not overlap"
                                                                      : "the intervals overlap"});
      drawn.push_back(estimate_row(entries[i].name, entries[i].time, predators ? 0 : 1));
    }
    page.paragraph(
        fmt::format("Strategies of the {}, the best first: time until the catch or the end, over all "
                    "strategies of the other side.",
                    side));
    page.table({"rank", "strategy", "time [s], mean and Student's interval", "against the next"}, ranked);
    page.figure(
        draw::draw_intervals(
            drawn,
            {.title = fmt::format("Strategies of the {}", side), .x_label = "s", .range = {}, .mark = {}}),
        "Mean time until the catch, or the end, with Student's 95 % intervals.");
  };
  ranking("predators", hunts, true);
  ranking("prey", escapes, false);
  page.table({"the paper", "here"}, {{"The predator hunts after the prey, while the prey's objective is to "
                                      "avoid the capture; both have different properties "
                                      "and use different strategies.",
                                      "The tables rank three strategies a side."}});
  return {};
}

// --- section 1: cooperation, central or distributed ---

Status transport(const ReproduceContext& context, ReportPage& page) {
  SL_ASSIGN(const std::vector<Measured> all,
            measure(context, {{"bids by radio", "transport", {{"control", "bids"}}},
                              {"one program", "transport", {{"control", "central"}}}}));
  SL_TRY(write_csv(context, "transport.csv", all));
  page.heading("Section 1: cooperation, distributed or centralised");
  page.paragraph(
      "Four robots move a beam that none of them can move alone. Distributed: each tells the others its "
      "charge, health and load by radio, "
      "and all settle their roles by bids. Centralised: one program gives the roles. Criterion: time of "
      "delivery.");
  std::vector<std::vector<std::string>> rows;
  for (const Measured& each : all) rows.push_back(cells(each));
  page.table(names, rows);
  const Estimate longer = paired_difference(
      all[1].runs, all[0].runs, [](const RepeatedRun& run) { return std::optional<double>(run.end_s); });
  page.table({"the paper", "here"},
             {{"The solving of the cooperation problem can be done either centralized or distributed to the "
               "team members; in the latter "
               "situation the robots receive information about their team-mates' resources and negotiate.",
               "Both deliver: " + compared(all[0].runs, all[1].runs) + ". Bids take longer by " +
                   text_of(longer) + " s, run by run."}});
  return {};
}

}  // namespace

Status make_cooperation(const ReproduceContext& context, ReportPage& page) {
  SL_TRY(clearing(context, page));
  SL_TRY(energy_and_time(context, page));
  SL_TRY(predator_prey(context, page));
  SL_TRY(transport(context, page));
  page.heading("Figures of the paper that are not shown");
  page.table({"figure", "why not"},
             {{"1 and 3: the objects of the simulator, its main loop",
               "Drawings without results; ours are in docs/architecture.md."},
              {"2: where the brain of a robot may be placed",
               "docs/teams.md has the clearing law in four places, as code of Sandlot, plugin, client in C++ "
               "and in Python: one "
               "run, to the hash. Clients need programs that do not come with this command."},
              {"Section 4's physical experiment with two small robots",
               "No robots were at hand; the paper has no numbers."},
              {"Section 1's football",
               "No numbers in the paper; docs/teams.md has a table of ours, scenarios/football.yaml."}});
  return {};
}

}  // namespace sandlot::app
