// The ring of records and their log: what goes in comes out, whatever else is damaged.
#include <doctest/doctest.h>

#include <cstring>
#include <random>

#include "explain/selector_fixture.hpp"
#include "plan/random.hpp"
#include "runtime/allocation_count.hpp"
#include "runtime/base/bytes.hpp"
#include "runtime/base/hash.hpp"
#include "runtime/select/choice.hpp"
#include "runtime/select/record_log.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

RecordHead headOf(std::uint64_t frame, std::uint32_t light, std::uint32_t methods)
{
    RecordHead head;
    head.frame = frame;
    head.lightId = light;
    head.method = light % 2;
    head.methods = methods;
    head.suitability = static_cast<float>(frame);
    return head;
}

std::vector<Candidate> candidatesOf(std::uint64_t frame, std::uint32_t count)
{
    std::vector<Candidate> out(count);
    for (std::uint32_t m = 0; m < count; ++m)
        out[m].quantised = static_cast<std::int32_t>(frame % 1000 + m);
    return out;
}

void fill(RecordRing& ring, std::uint64_t first, std::uint64_t last, std::uint32_t lights, std::uint32_t methods)
{
    for (std::uint64_t frame = first; frame <= last; ++frame) {
        ring.begin(frame, lights, methods, nullptr);
        for (std::uint32_t light = 0; light < lights; ++light)
            ring.add(headOf(frame, 10 + light, methods), candidatesOf(frame, methods));
    }
}

SelectorFixture makeFixture()
{
    std::optional<rules::Engine> engine = bindRules(fixtureRules());
    REQUIRE(engine.has_value());
    return SelectorFixture(std::move(*engine));
}

/// Frames of a light that walks away, with a veto, a refusal and a light that nothing serves.
DecisionLog walk(SelectorFixture& fixture)
{
    DecisionLog log;
    log.frameOrigin = 1;
    for (const MethodWords& method : methodWords())
        log.methods.push_back({std::string(method.name), GN_TRAIT_SPOT_BIT, ""});
    log.methods[0].unavailable = "needs a device";
    log.rulesName = "fixture";
    log.rulesText = fixtureRules();
    log.preset = "low";
    log.lights = {{1, "lamp"}};
    Situation situation;
    situation.method("ray_traced").exclusion = Exclusion::refused;
    situation.method("ray_traced").refusal = "no trees today";
    for (int i = 0; i < 20; ++i) {
        situation.fact(Fact::viewerDistance) = 4.0 * i;
        situation.fact(Fact::casterTriangles) = 2.0 + 0.25 * i;
        situation.budgetMs = i % 2 ? 5.0 : 0.0;
        if (i == 19) situation.fact(Fact::lightMotion) = std::numeric_limits<double>::quiet_NaN();
        const DecisionRecord record = fixture.decide(situation);
        situation.incumbent = record.method;
        log.add(record);
    }
    return log;
}

std::string answers(const DecisionRecord& record, const ExplainWords& words)
{
    std::string text = explainWhy(record, words) + explainWhatIf(record, words);
    for (std::uint32_t m = 0; m < record.methods; ++m)
        text += explainWhyNot(record, m, words);
    return text;
}

/// A chunk whose hash fits whatever stands in it.
std::string sealed(std::string chunk)
{
    ByteWriter hash;
    hash.integer(hashOfBytes(std::string_view(chunk).substr(0, chunk.size() - 8)));
    chunk.replace(chunk.size() - 8, 8, hash.bytes);
    return chunk;
}

} // namespace

TEST_CASE("the ring keeps 256 frames, finds a light in each, and grows without losing any")
{
    RecordRing ring;
    CHECK(ring.newest() == 0);
    CHECK(ring.oldest() == 0);
    CHECK(!ring.has(0));
    fill(ring, 5, 400, 3, 4);
    CHECK(ring.newest() == 400);
    CHECK(ring.oldest() == 145);
    CHECK(!ring.has(144));
    CHECK(!ring.has(401));
    DecisionRecord record;
    CHECK(!ring.find(144, 10, record));
    CHECK(!ring.find(300, 13, record));
    fill(ring, 401, 410, 9, 6); // more of both
    for (const std::uint64_t frame : {155u, 300u, 400u, 405u, 410u}) {
        REQUIRE(ring.find(frame, 12, record));
        CHECK(record.frame == frame);
        CHECK(record.lightId == 12);
        CHECK(record.methods == (frame > 400 ? 6u : 4u));
        CHECK(record.candidates[3].quantised == static_cast<std::int32_t>(frame % 1000 + 3));
    }
    CHECK(ring.lights(400) == 3);
    CHECK(ring.lights(410) == 9);

    ring.noteMeasured(400, 12, 0, 2.5f);
    ring.noteMeasured(399, 12, 1, 2.5f); // another method served
    REQUIRE(ring.find(400, 12, record));
    CHECK(record.measuredMs == 2.5f);
    REQUIRE(ring.find(399, 12, record));
    CHECK(record.measuredMs == 0.0f);
}

TEST_CASE("a ring in use allocates nothing, and its heads hold no memory of their own")
{
    static_assert(std::is_trivially_copyable_v<RecordHead>);
    RecordRing ring;
    fill(ring, 1, 1, 8, 6);
    const std::vector<Candidate> candidates = candidatesOf(1, 6);
    const size_t before = allocationCount();
    for (std::uint64_t frame = 2; frame < 1000; ++frame) {
        ring.begin(frame, 8, 6, nullptr);
        for (std::uint32_t light = 0; light < 8; ++light)
            ring.add(headOf(frame, light, 6), candidates);
    }
    CHECK(allocationCount() == before);
}

TEST_CASE("a record keeps the strongest rules, strongest first, with what limits them")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.fact(Fact::viewerDistance) = 40.0; // near 2/3, far 1/3
    situation.fact(Fact::casterTriangles) = 4.2; // huge 0.1
    const DecisionRecord record = fixture.decide(situation);
    const char* ids[] = {"A1", "A2", "V1"};
    const float strengths[] = {2.0f / 3.0f, 1.0f / 3.0f, 0.1f};
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(std::string(fixture.engine().ruleId(record.fired[i].rule)) == ids[i]);
        CHECK(record.fired[i].strength == doctest::Approx(strengths[i]));
    }
    CHECK(std::string(fixture.engine().variableName(record.fired[2].variable)) == "casterTriangles");
    CHECK(record.fired[3].rule == rules::kNoRule);
}

TEST_CASE("a record keeps what counts of a rule, and its explanation says what the rule yields to")
{
    std::string text(fixtureRules());
    const std::string_view policy = "policy:";
    text.insert(text.find(policy), "  - {id: EX, priority: 1, rule: \"if viewerDistance is near then stencil_volume is "
                                   "avoided with 0.9\"}\n");
    std::optional<rules::Engine> engine = bindRules(text);
    REQUIRE(engine.has_value());
    SelectorFixture fixture(std::move(*engine));
    const DecisionRecord record = fixture.decide({}); // near 1: A1 fires with 1, and counts fully for other methods
    CHECK(std::string(fixture.engine().ruleId(record.fired[0].rule)) == "A1");
    CHECK(std::string(fixture.engine().ruleId(record.fired[1].rule)) == "EX");
    const std::string why = explainWhyNot(record, methodNamed("stencil_volume"), fixture.words());
    INFO(why);
    CHECK(why.find("EX (avoided)") < why.find("rule A1"));
    CHECK(contains(why, "-> strength 1.00, yields to EX, counts 0.10\n"));
}

TEST_CASE("a record is explained by the rules it was decided by, whatever was loaded since")
{
    SelectorFixture fixture = makeFixture();
    Situation situation;
    situation.fact(Fact::viewerDistance) = 10.0;
    DecisionRecord record = fixture.decide(situation);
    auto decided = std::make_shared<const rules::Engine>(fixture.engine());
    const std::weak_ptr<const rules::Engine> watched = decided;
    RecordRing ring;
    ring.begin(record.frame, 1, record.methods, std::move(decided));
    ring.add(record, record.all());
    ring.begin(record.frame + 1, 1, record.methods, nullptr); // the rules were taken away
    CHECK(ring.rules(record.frame + 1) == nullptr);
    REQUIRE(ring.rules(record.frame) == watched.lock());
    const DecisionRecord kept = ring.at(record.frame, 0);
    REQUIRE(kept.fired[0].rule != rules::kNoRule);
    for (std::size_t i = 0; i < kFiredRules; ++i) {
        CHECK(kept.fired[i].rule == record.fired[i].rule);
        CHECK(kept.fired[i].strength == record.fired[i].strength);
    }
    // ... and let go when the frame leaves the ring.
    ring.begin(record.frame + RecordRing::kFrames, 1, record.methods, nullptr);
    CHECK(watched.expired());
}

TEST_CASE("a log read back answers every question with the same words")
{
    SelectorFixture fixture = makeFixture();
    const DecisionLog log = walk(fixture);
    const std::string bytes = writeDecisionLog(log);
    const std::string twice = bytes + bytes;
    std::string_view rest = twice;
    for (int chunk = 0; chunk < 2; ++chunk) {
        const Result<DecisionLog> read = readDecisionLog(rest);
        REQUIRE(bool(read));
        CHECK(read->frameOrigin == 1);
        CHECK(read->rulesText == fixtureRules());
        CHECK(read->preset == "low");
        CHECK(read->methods[0].unavailable == "needs a device");
        REQUIRE(read->heads.size() == log.heads.size());
        for (std::size_t i = 0; i < log.heads.size(); ++i) {
            CHECK(answers(read->record(i), fixture.words()) == answers(log.record(i), fixture.words()));
            CHECK(read->heads[i].reason == log.heads[i].reason);
        }
        CHECK(contains(answers(read->record(0), fixture.words()), "no trees today"));
        CHECK(writeDecisionLog(*read) == bytes);
    }
    CHECK(rest.empty());
    MESSAGE("bytes a record: " << (bytes.size() - fixtureRules().size()) / log.heads.size());
}

TEST_CASE("a method that was added later is that in a log, too, and among the methods of the frame no more")
{
    SelectorFixture fixture = makeFixture();
    DecisionLog log = walk(fixture);
    const auto later = static_cast<std::uint32_t>(log.methods.size());
    log.methods.push_back({"later", GN_TRAIT_SPOT_BIT, ""});
    std::vector<Candidate> wider;
    for (std::size_t i = 0; i < log.heads.size(); ++i) {
        wider.insert(wider.end(), log.candidates.begin() + static_cast<std::ptrdiff_t>(i * later),
                     log.candidates.begin() + static_cast<std::ptrdiff_t>((i + 1) * later));
        wider.emplace_back();
    }
    log.candidates = std::move(wider);
    std::vector<MethodWords> methods = methodWords();
    methods.push_back({"later", ""});
    const ExplainWords words{.methods = methods, .engine = &fixture.engine(), .light = "lamp"};
    const std::string bytes = writeDecisionLog(log);
    std::string_view rest = bytes;
    const Result<DecisionLog> read = readDecisionLog(rest);
    REQUIRE(bool(read));
    for (std::size_t i = 0; i < log.heads.size(); ++i) {
        CHECK(read->heads[i].methods == later);
        CHECK(answers(read->record(i), words) == answers(log.record(i), words));
        CHECK(contains(explainWhyNot(read->record(i), later, words), "later was added later"));
    }
    RecordRing ring;
    ring.begin(1, 1, 3, nullptr);
    ring.begin(2, 1, 4, nullptr);
    CHECK(ring.methods(1) == 3);
    CHECK(ring.methods(2) == 4);
    CHECK(ring.methods(3) == 0);
}

TEST_CASE("a log that is cut short, damaged, foreign or of another version is an error that says so")
{
    SelectorFixture fixture = makeFixture();
    const std::string bytes = writeDecisionLog(walk(fixture));
    const auto errorOf = [](std::string_view text) {
        const Result<DecisionLog> read = readDecisionLog(text);
        REQUIRE(!read);
        return read.error().text;
    };
    for (std::size_t size = 0; size < bytes.size(); size += 7)
        CHECK(!errorOf(std::string_view(bytes).substr(0, size)).empty());
    std::string damaged = bytes;
    damaged[bytes.size() / 2] ^= 1;
    CHECK(contains(errorOf(damaged), "hash"));
    std::string other = bytes;
    other[7] = '1';
    CHECK(contains(errorOf(other), "version"));
    CHECK(contains(errorOf("frame,light,method\n"), "does not start"));
    CHECK(contains(errorOf(std::string_view(bytes).substr(0, 100)), "cut short"));
}

TEST_CASE("whatever bytes a log holds, reading ends in a log or an error, and a log answers")
{
    SelectorFixture fixture = makeFixture();
    DecisionLog small = walk(fixture);
    small.heads.resize(2);
    small.candidates.resize(2 * small.methods.size());
    const std::string bytes = writeDecisionLog(small);
    Random random(7);
    std::uint32_t logs = 0, errors = 0;
    for (int i = 0; i < 20000; ++i) {
        std::string mutated = bytes;
        for (std::uint32_t k = 1 + random.below(3); k > 0; --k) {
            // Half of the damage goes into the records, behind the rule base.
            const bool late = random.below(2) == 0;
            const std::size_t from = late ? bytes.size() - 900 : 12;
            const std::size_t at = from + random.below(static_cast<std::uint32_t>(bytes.size() - 8 - from));
            mutated[at] = static_cast<char>(random.below(3) ? random.bits() : 0xff);
        }
        const std::string text = sealed(std::move(mutated));
        std::string_view rest = text;
        const Result<DecisionLog> read = readDecisionLog(rest);
        if (!read) {
            ++errors;
            CHECK(!read.error().text.empty());
            continue;
        }
        ++logs;
        if (read->methods.size() != methodWords().size()) continue;
        for (std::size_t k = 0; k < read->heads.size(); ++k)
            CHECK(lineCount(explainWhy(read->record(k), fixture.words())) <= kMostExplanationLines);
    }
    CHECK(logs > 1000);
    CHECK(errors > 1000);
}

TEST_CASE(
    "without a budget the cheapest of those that show as much serves, and stays until something is clearly cheaper")
{
    std::array<Candidate, 4> all{};
    const auto set = [&](uint32_t m, int32_t suitability, float quality, float ms) {
        all[m] = {.quantised = suitability, .quality = quality, .predictedMs = ms, .sureMs = ms};
    };
    set(0, 3400, 0.995f, 30.0f); // best suited
    set(1, 2000, 1.0f, 20.0f);   // shows as much, cheaper
    set(2, 3000, 0.8f, 2.0f);    // shows less
    set(3, 600, 1.0f, 1.0f);     // avoided by the rules
    CHECK(cheaperEqual(all, 0, UINT32_MAX) == 1);
    all[1].sureMs = 28.0f; // saves less than a tenth
    CHECK(cheaperEqual(all, 0, 0) == 0);
    CHECK(cheaperEqual(all, 0, 1) == 1);          // but where it serves already it stays
    CHECK(cheaperEqual(all, 0, 2) == 1);          // and where there is a change anyway any saving will do,
    CHECK(cheaperEqual(all, 0, UINT32_MAX) == 1); // to begin with, too
    all[1].sureMs = 31.0f;
    CHECK(cheaperEqual(all, 0, UINT32_MAX) == 0);
    CHECK(cheaperEqual(all, 0, 1) == 0);
    all[1].sureMs = 20.0f;
    all[1].sureMs = 35.0f; // predicted at 20, but nobody has timed it
    CHECK(cheaperEqual(all, 0, UINT32_MAX) == 0);
    all[1].sureMs = 20.0f;
    all[1].sharedMs = 9.0f; // for its view
    CHECK(cheaperEqual(all, 0, 0) == 0);
    CHECK(cheaperEqual(all, 0, 1) == 1); // 29 of 30 ms
    all[1].sharedMs = 11.0f;
    CHECK(cheaperEqual(all, 0, 1) == 0);
    all[0].sharedMs = 9.0f;
    CHECK(cheaperEqual(all, 0, 0) == 1);
    all[0].sharedMs = all[1].sharedMs = 0.0f;
    all[1].exclusion = Exclusion::vetoed;
    CHECK(cheaperEqual(all, 0, UINT32_MAX) == 0);
    all[1].exclusion = Exclusion::none;
    all[3].quantised = 1700; // half as well is enough
    CHECK(cheaperEqual(all, 0, 1) == 3);
    CHECK(cheaperEqual(all, UINT32_MAX, 1) == UINT32_MAX);
}

TEST_CASE("without a budget what shows more serves where it is costlier by a tenth at most, twice that where it serves "
          "already")
{
    std::array<Candidate, 3> all{};
    const auto set = [&](uint32_t m, int32_t suitability, float quality, float ms) {
        all[m] = {.quantised = suitability, .quality = quality, .predictedMs = ms, .sureMs = ms};
    };
    set(0, 3400, 0.97f, 10.0f); // best suited
    set(1, 2000, 0.985f, 10.5f);
    set(2, 2000, 1.0f, 10.9f);
    CHECK(cheaperEqual(all, 0, 0) == 2);
    set(2, 2000, 1.0f, 11.1f);
    CHECK(cheaperEqual(all, 0, 0) == 1);
    CHECK(cheaperEqual(all, 0, 2) == 2);
    set(2, 2000, 1.0f, 12.1f);
    CHECK(cheaperEqual(all, 0, 2) == 1);
    set(2, 1600, 1.0f, 9.5f); // the rules avoid it
    CHECK(cheaperEqual(all, 0, 0) == 1);
    set(1, 2000, 0.979f, 9.5f); // shows as much, and saves too little
    CHECK(cheaperEqual(all, 0, 0) == 0);
    set(1, 2000, 0.985f, 9.5f);
    all[1].sureMs = 15.0f; // nobody has timed it
    CHECK(cheaperEqual(all, 0, 0) == 0);
    all[1].sureMs = 9.5f;
    set(2, 2000, 0.99f, 8.0f); // shows as much as what is wanted by now, for less
    CHECK(cheaperEqual(all, 0, 0) == 2);
}

TEST_CASE("without a budget what shows more is held against the cheapest that shows enough, not against what is wanted")
{
    std::array<Candidate, 4> all{};
    const auto set = [&](uint32_t m, int32_t suitability, float quality, float ms) {
        all[m] = {.quantised = suitability, .quality = quality, .predictedMs = ms, .sureMs = ms};
    };
    set(0, 3400, 0.95f, 20.0f); // best suited
    set(1, 2000, 0.97f, 12.0f);
    set(2, 2000, 1.0f, 21.9f); // a tenth costlier than what is wanted
    set(3, 2000, 1.0f, 30.0f);
    for (const uint32_t incumbent : {0u, 1u, 2u, 3u, UINT32_MAX}) {
        CAPTURE(incumbent);
        CHECK(cheaperEqual(all, 0, incumbent) == 1);
    }
    set(2, 2000, 1.0f, 13.1f);
    CHECK(cheaperEqual(all, 0, 1) == 2);
    // Of two that show as much, the cheaper, whichever comes first.
    set(3, 2000, 1.0f, 12.9f);
    CHECK(cheaperEqual(all, 0, 1) == 3);
    CHECK(cheaperEqual(all, 0, UINT32_MAX) == 3);
    CHECK(cheaperEqual(all, 0, 2) == 2); // where it serves already
    std::swap(all[2], all[3]);
    CHECK(cheaperEqual(all, 0, UINT32_MAX) == 2);
    CHECK(cheaperEqual(all, 0, 3) == 3);
}

TEST_CASE("without a budget methods do not take turns while nothing changes")
{
    std::uint32_t most = 0;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> share(0.0f, 1.0f);
    for (int trial = 0; trial < 100000; ++trial) {
        std::array<Candidate, 6> all{};
        for (Candidate& candidate : all) {
            const float ms = 10.0f + 3.0f * share(random); // close, or no margin would matter
            candidate = {.quantised = 1000 + static_cast<int32_t>(3000.0f * share(random)),
                         .quality = 0.95f + 0.05f * share(random),
                         .predictedMs = ms,
                         .sureMs = (share(random) < 0.1f ? 1.6f : 1.0f) * ms,
                         .firstMs = 30.0f * share(random) * share(random),
                         .sharedMs = share(random)};
        }
        uint32_t wanted = 0;
        for (uint32_t m = 1; m < all.size(); ++m)
            if (all[m].quantised > all[wanted].quantised) wanted = m;
        const auto incumbent = static_cast<uint32_t>(random() % (all.size() + 1));
        uint32_t chosen = cheaperEqual(all, wanted, incumbent);
        // "As much" is not transitive: what is as good as the one need not be as good as the other, so there may be
        // steps in between.
        std::uint32_t steps = 0;
        for (std::uint32_t next; (next = cheaperEqual(all, wanted, chosen)) != chosen && steps < all.size(); ++steps)
            chosen = next;
        most = std::max(most, steps);
        REQUIRE(steps < all.size());
    }
    MESSAGE("steps until nothing changes, at most: ", most);
}

TEST_CASE("within the near floor the best suited of what reaches it is wanted, and where nothing does what shows most")
{
    std::array<Candidate, 4> all{};
    all[0] = {.quantised = 3000, .quality = 0.6f};  // a coarse map
    all[1] = {.quantised = 2000, .quality = 0.99f}; // a volume
    all[2] = {.quantised = 2500, .quality = 0.9f};  // a finer map
    all[3] = {.exclusion = Exclusion::roundTrips, .quantised = 4000, .quality = 1.0f};
    CHECK(suitedWithinFloor(all, 0, 0.5f) == 0);
    CHECK(suitedWithinFloor(all, 0, 0.875f) == 2);
    CHECK(suitedWithinFloor(all, 0, 0.95f) == 1);
    CHECK(suitedWithinFloor(all, 0, 0.999f) == 1); // what shows most of what may serve
    all[1].quantised = -1;                         // nobody speaks of it
    CHECK(suitedWithinFloor(all, 0, 0.95f) == 2);
}

TEST_CASE("without a budget a map of what stands still must earn its first frame before it serves for its price")
{
    std::array<Candidate, 2> all{};
    all[0] = {.quantised = 3000, .quality = 1.0f, .predictedMs = 2.2f, .sureMs = 2.2f};
    all[1] = {.quantised = 3000, .quality = 1.0f, .predictedMs = 1.5f, .sureMs = 1.5f, .firstMs = 20.0f};
    CHECK(cheaperEqual(all, 0, 0) == 1); // 0.7 ms for a second of frames: twice what it takes
    CHECK(priceOf(all, 1, 1) == 1.5f);   // paid already
    all[1].firstMs = 60.0f;
    CHECK(cheaperEqual(all, 0, 0) == 0);
    CHECK(cheaperEqual(all, 0, 1) == 1); // and stays where it has been paid
    all[0].firstMs = 60.0f;              // to begin with, both cost it
    CHECK(cheaperEqual(all, 0, UINT32_MAX) == 1);
}
