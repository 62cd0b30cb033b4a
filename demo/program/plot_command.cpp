// `gnomon plot`: the terms of a rule base, and who wins over two of its facts. No device needed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "demo/io/file.hpp"
#include "demo/program/checks.hpp"
#include "demo/program/commands.hpp"
#include "demo/program/pictures.hpp"
#include "demo/program/rule_support.hpp"
#include "demo/program/session.hpp"
#include "demo/report/markup.hpp"
#include "demo/report/page.hpp"

namespace gnomon::demo {

namespace {

constexpr double kWidth = 500.0, kHeight = 190.0, kSurfaceHeight = 320.0;
constexpr size_t kCells = 60; // a side of a surface: a few pixels each

/// A line through the corners of every term; infinite ones end at the edge of the universe.
Drawing termsDrawing(const rules::Variable& variable)
{
    SvgChart chart(kWidth, kHeight,
                   {.low = variable.low,
                    .high = variable.high,
                    .title = variable.name + (variable.unit.empty() ? "" : ", " + variable.unit)},
                   {.low = 0.0, .high = 1.0, .title = "membership"});
    Legend entries;
    for (const rules::Term& term : variable.terms) {
        const rules::Trapezoid& shape = term.shape;
        Points points{{variable.low, shape.membership(variable.low)}};
        for (const auto& [x, membership] :
             {std::pair(shape.a, 0.0), std::pair(shape.b, 1.0), std::pair(shape.c, 1.0), std::pair(shape.d, 0.0)})
            if (x >= variable.low && x <= variable.high) points.emplace_back(x, membership); // both ends of an edge
        points.emplace_back(variable.high, shape.membership(variable.high));
        entries.emplace_back(term.name, seriesColour(entries.size()));
        chart.line(points, entries.back().second, 2.0);
    }
    return {variable.name, std::move(chart), std::move(entries)};
}

const rules::Variable& variableOf(const rules::Engine& engine, const std::string& name)
{
    std::vector<std::string_view> known;
    for (const rules::Variable& variable : engine.base().variables) {
        if (variable.name == name) return variable;
        known.push_back(variable.name);
    }
    throw HostError("--over: no variable '" + name + "'" + rules::suggestion(name, known));
}

size_t factOf(const rules::Engine& engine, const std::string& name)
{
    const auto& facts = engine.facts();
    return size_t(std::find_if(facts.begin(), facts.end(), [&](const auto& fact) { return fact.name == name; }) -
                  facts.begin());
}

/// Of those that compete the best suited one; the first of equals. None where no rule speaks.
std::optional<uint32_t> winnerOf(const rules::Inference& inference, std::span<const uint32_t> competing)
{
    std::optional<uint32_t> best;
    for (const uint32_t output : competing) {
        const rules::OutputState& state = inference.outputs[output];
        if (state.vetoed || !state.hasOpinion) continue;
        if (!best || state.quantised > inference.outputs[*best].quantised) best = output;
    }
    return best;
}

/// Paler where the suitability is lower.
Rgb8 shaded(const Rgb8& colour, double suitability)
{
    const auto mix = [=](uint8_t c) {
        const double strength = 0.25 + 0.75 * std::clamp(suitability, 0.0, 1.0);
        return static_cast<uint8_t>(std::lround(255.0 + (c - 255.0) * strength));
    };
    return {mix(colour.r), mix(colour.g), mix(colour.b)};
}

struct Won {
    uint32_t output;
    int percent; ///< Suitability.
    bool operator==(const Won&) const = default;
};

/// Cells side by side that look the same, and as many rows of them as lie under one another.
struct Block {
    size_t column, end, row, rows;
    Won won;
};

/// \param look (column, row) -> std::optional<Won>
std::vector<Block> blocksOf(const auto& look)
{
    std::vector<Block> blocks;
    std::vector<size_t> below, here; // of the row before, and of this one
    for (size_t row = 0; row < kCells; ++row, below.swap(here), here.clear())
        for (size_t column = 0, end = 0; column < kCells; column = end) {
            const std::optional<Won> won = look(column, row);
            end = column + 1;
            while (end < kCells && look(end, row) == won)
                ++end;
            if (!won) continue;
            const auto same = std::find_if(below.begin(), below.end(), [&](size_t i) {
                return blocks[i].column == column && blocks[i].end == end && blocks[i].won == *won;
            });
            here.push_back(same == below.end() ? blocks.size() : *same);
            if (same == below.end()) blocks.push_back({column, end, row, 0, *won});
            ++blocks[here.back()].rows;
        }
    return blocks;
}

/// Who wins over two variables, among outputs that compete; the other facts are as given.
Drawing surface(const rules::Engine& engine, std::span<const uint32_t> competing, const rules::Variable& x,
                const rules::Variable& y, std::vector<double> facts, const std::string& title)
{
    const auto axis = [](const rules::Variable& v) {
        return Axis{.low = v.low, .high = v.high, .title = v.name + (v.unit.empty() ? "" : ", " + v.unit)};
    };
    const auto at = [](const rules::Variable& v, double cell) { return v.low + (v.high - v.low) * cell / kCells; };
    SvgChart chart(kWidth, kSurfaceHeight, axis(x), axis(y));
    rules::Inference inference = engine.makeInference();
    std::set<uint32_t> winners;
    const auto look = [&](size_t column, size_t row) -> std::optional<Won> {
        facts[factOf(engine, x.name)] = at(x, double(column) + 0.5);
        facts[factOf(engine, y.name)] = at(y, double(row) + 0.5);
        engine.evaluate(facts, inference);
        const std::optional<uint32_t> winner = winnerOf(inference, competing);
        if (!winner) return std::nullopt;
        return Won{*winner, 100 * inference.outputs[*winner].quantised / rules::kSuitabilitySteps};
    };
    for (const Block& block : blocksOf(look)) {
        winners.insert(block.won.output);
        const std::string& name = engine.outputs()[block.won.output].name;
        chart.box(at(x, double(block.column)), at(x, double(block.end)), at(y, double(block.row)),
                  at(y, double(block.row + block.rows)), shaded(methodColour(name), block.won.percent / 100.0),
                  name + " " + fixed(block.won.percent / 100.0, 2));
    }
    Legend entries;
    for (const uint32_t winner : winners)
        entries.emplace_back(engine.outputs()[winner].name, methodColour(engine.outputs()[winner].name));
    return {title, std::move(chart), std::move(entries)};
}

/// One for each kind of light that the base names. \param isWanted by the kind's name
std::vector<Drawing> surfaces(const rules::Engine& engine, const std::string& over, const std::string& facts,
                              const auto& isWanted)
{
    const std::vector<std::string> names = parseNames(over);
    if (names.size() != 2) throw HostError("--over: '" + over + "' is not two variables, such as a,b");
    if (names[0] == names[1]) throw HostError("--over: '" + names[0] + "' stands there twice");
    const rules::Variable &x = variableOf(engine, names[0]), &y = variableOf(engine, names[1]);
    const std::vector<double> values = parseFacts(facts, runtimeVocabulary());
    std::vector<Drawing> out;
    const auto& kinds = engine.compiled().kinds;
    for (size_t kind = 0; kind < kinds.size(); ++kind) {
        const bool named = kinds.size() == engine.base().kinds.size();
        if (named && !isWanted(engine.base().kinds[kind].name)) continue;
        out.push_back(surface(engine, kinds[kind], x, y, values,
                              "Best suited, " + (named ? engine.base().kinds[kind].name + " lights" : "all methods")));
    }
    return out;
}

void requireDrawable(const std::vector<std::string>& names, const rules::RuleBase& base)
{
    std::vector<std::string_view> known;
    for (const rules::Variable& variable : base.variables)
        known.push_back(variable.name);
    known.push_back(base.suitability.name);
    for (const auto& kind : base.kinds)
        known.push_back(kind.name);
    for (const std::string& name : names)
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw HostError("--only: no variable or kind '" + name + "'" + rules::suggestion(name, known));
}

std::string pageOf(const std::string& name, const std::vector<Drawing>& drawings, const std::string& note)
{
    std::string body = "<section><h1>" + escaped(name) + "</h1>" + (note.empty() ? "" : "<p class=\"note\">") +
                       escaped(note) + (note.empty() ? "" : "</p>") + "<div class=\"charts\">";
    for (const Drawing& drawing : drawings)
        body += "<figure><figcaption>" + escaped(drawing.title) + "</figcaption>" + drawing.chart.svg() +
                legend(drawing.entries) + "</figure>";
    return page("gnomon rules: " + name, body + "</div></section>\n");
}

} // namespace

int plotCommand(const PlotOptions& options)
{
    requireWritable(options.out);
    rules::BindResult bound = rules::Engine::bind(parseRules(options.rules), runtimeVocabulary().view());
    if (report(bound.diagnostics) || !bound.engine) return 1;
    const rules::RuleBase& base = bound.engine->base();
    const std::vector<std::string> only = parseNames(options.only);
    requireDrawable(only, base);
    const auto isWanted = [&only](const std::string& name) {
        return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
    };
    std::vector<Drawing> drawings;
    for (const rules::Variable& variable : base.variables)
        if (isWanted(variable.name)) drawings.push_back(termsDrawing(variable));
    if (isWanted(base.suitability.name)) drawings.push_back(termsDrawing(base.suitability));
    std::string note;
    if (!options.over.empty()) {
        note = (options.facts.empty() ? std::string("All other facts are unknown.") : "With " + options.facts + ".") +
               " Pale: hardly suited. White: no rule speaks.";
        for (Drawing& drawing : surfaces(*bound.engine, options.over, options.facts, isWanted))
            drawings.push_back(std::move(drawing));
    }
    const std::filesystem::path out = options.out;
    expect(
        writeFile(out, out.extension() == ".svg" ? svgPicture(drawings, 2, note) : pageOf(base.name, drawings, note)));
    std::printf("%s\n", std::filesystem::absolute(out).lexically_normal().c_str());
    return 0;
}

} // namespace gnomon::demo
