#include "runtime/select/record_log.hpp"

#include <algorithm>
#include <cstring>

#include "runtime/base/bytes.hpp"
#include "runtime/base/hash.hpp"

namespace gnomon {

namespace {

constexpr std::string_view kMagic = "GNDECID9";
constexpr std::uint8_t kNoMethod = 255;
constexpr std::uint16_t kNoRefusal = 65535;
enum : std::uint8_t {
    kBudgeted = 1,
    kSwitched = 2,
    kFloor = 4,
    kFloorUnmet = 8,
    kPriced = 16,
    kGuessed = 32,
    kFlatSource = 64,
    kAsksHost = 128
};

std::uint8_t packMethod(std::uint32_t method)
{
    return method < kMaxMethods ? static_cast<std::uint8_t>(method) : kNoMethod;
}

void writeMethods(ByteWriter& out, const MethodSet& methods)
{
    out.integer(static_cast<std::uint8_t>(methods.count()));
    for (const std::uint32_t method : methods)
        out.integer(packMethod(method));
}

/// The numbers of a head that are plain floats, in the order of the file.
template <typename Head>
auto floatsOf(Head& head)
{
    return std::array{&head.floorTruth,  &head.floorStrength, &head.minimumQuality, &head.importance,
                      &head.suitability, &head.measuredMs,    &head.budgetMs,       &head.usableMs,
                      &head.planMs,      &head.errorMs,       &head.threshold,      &head.leastMs};
}

void writeHead(ByteWriter& out, const ReasonedHead& head)
{
    out.integer(head.frame);
    out.integer(head.ruleHash);
    out.integer(head.knowledge);
    out.integer(head.lightId);
    out.integer(static_cast<std::uint8_t>(head.methods));
    for (const std::uint32_t method : {head.method, head.wanted, head.incumbent, head.pinned})
        out.integer(packMethod(method));
    writeMethods(out, head.fallbacks);
    out.integer(head.distanceAge);
    out.integer(static_cast<std::uint8_t>(head.reason));
    out.integer(static_cast<std::uint8_t>(head.replan));
    out.integer(static_cast<std::uint8_t>(head.hold));
    out.integer(static_cast<std::uint8_t>((head.budgeted ? kBudgeted : 0) | (head.switched ? kSwitched : 0) |
                                          (head.floor ? kFloor : 0) | (head.floorUnmet ? kFloorUnmet : 0) |
                                          (head.priced ? kPriced : 0) | (head.guessed ? kGuessed : 0) |
                                          (head.flatSource ? kFlatSource : 0) | (head.asksHost ? kAsksHost : 0)));
    out.integer(head.mapSide);
    out.integer(head.wantedSide);
    out.integer(head.redrawEvery);
    out.integer(head.mapAge);
    for (const float* value : floatsOf(head))
        out.real(*value);
    for (const double fact : head.facts)
        out.real(fact);
    const auto fired = std::count_if(head.fired.begin(), head.fired.end(),
                                     [](const FiredRule& rule) { return rule.rule != rules::kNoRule; });
    out.integer(static_cast<std::uint8_t>(fired));
    for (const FiredRule& rule : head.fired) {
        if (rule.rule == rules::kNoRule) continue;
        out.integer(rule.rule);
        out.integer(rule.variable);
        out.integer(rule.term);
        out.real(rule.strength);
        out.real(rule.membership);
        out.real(rule.weight);
    }
}

void writeCandidate(ByteWriter& out, const Candidate& candidate, std::span<const std::string_view> refusals)
{
    out.integer(static_cast<std::int16_t>(candidate.quantised));
    out.integer(static_cast<std::uint8_t>(candidate.exclusion));
    out.integer(static_cast<std::uint8_t>(candidate.why));
    out.real(candidate.quality);
    out.real(candidate.predictedMs);
    out.real(candidate.sureMs);
    out.real(candidate.firstMs);
    out.real(candidate.sharedMs);
    if (candidate.exclusion == Exclusion::none) return;
    out.integer(candidate.detail);
    const auto refusal =
        candidate.refusal ? std::find(refusals.begin(), refusals.end(), candidate.refusal) : refusals.end();
    out.integer(refusal == refusals.end() ? kNoRefusal : static_cast<std::uint16_t>(refusal - refusals.begin()));
}

/// Different reasons among the candidates; there are a handful in the whole library.
std::vector<std::string_view> refusalsOf(const DecisionLog& log)
{
    std::vector<std::string_view> found;
    for (const Candidate& candidate : log.candidates)
        if (candidate.refusal && found.size() < kNoRefusal &&
            std::find(found.begin(), found.end(), candidate.refusal) == found.end())
            found.emplace_back(candidate.refusal);
    return found;
}

} // namespace

void DecisionLog::add(const DecisionRecord& record)
{
    heads.push_back(record);
    candidates.insert(candidates.end(), record.candidates.begin(), record.candidates.end());
    candidates.resize(heads.size() * methods.size()); // those added later
}

DecisionRecord DecisionLog::record(std::size_t index) const
{
    DecisionRecord out;
    static_cast<ReasonedHead&>(out) = heads[index];
    const auto first = candidates.begin() + static_cast<std::ptrdiff_t>(index * methods.size());
    out.candidates.assign(first, first + static_cast<std::ptrdiff_t>(out.methods));
    return out;
}

std::string writeDecisionLog(const DecisionLog& log)
{
    ByteWriter out;
    out.bytes = kMagic;
    out.integer(std::uint32_t{0}); // the size, set at the end
    out.integer(log.frameOrigin);
    out.integer(static_cast<std::uint8_t>(log.software));
    out.integer(static_cast<std::uint8_t>(log.methods.size()));
    for (const LoggedMethod& method : log.methods) {
        out.text(method.name);
        out.integer(method.traits);
        out.text(method.unavailable);
    }
    out.integer(static_cast<std::uint8_t>(kFactCount));
    for (const FactName& fact : kFactNames)
        out.text(fact.name);
    out.text(std::string_view(log.rulesName).substr(0, kMaxLogNameBytes));
    out.text(log.rulesText);
    out.text(log.preset);
    out.integer(static_cast<std::uint32_t>(log.lights.size()));
    for (const LoggedLight& light : log.lights) {
        out.integer(light.id);
        out.text(std::string_view(light.name).substr(0, kMaxLogNameBytes));
    }
    const std::vector<std::string_view> refusals = refusalsOf(log);
    out.integer(static_cast<std::uint16_t>(refusals.size()));
    for (const std::string_view refusal : refusals)
        out.text(refusal);
    out.integer(static_cast<std::uint32_t>(log.heads.size()));
    for (std::size_t i = 0; i < log.heads.size(); ++i) {
        writeHead(out, log.heads[i]);
        for (std::size_t m = 0; m < log.heads[i].methods; ++m)
            writeCandidate(out, log.candidates[i * log.methods.size() + m], refusals);
    }
    ByteWriter size;
    size.integer(static_cast<std::uint32_t>(out.bytes.size() + sizeof(std::uint64_t)));
    out.bytes.replace(kMagic.size(), size.bytes.size(), size.bytes);
    out.integer(hashOfBytes(out.bytes));
    return std::move(out.bytes);
}

namespace {

/// Reads one chunk; the first fault is kept.
class ChunkReader {
public:
    explicit ChunkReader(std::string_view chunk) : in_(chunk) {}

    Result<DecisionLog> read()
    {
        in_.integer<std::uint64_t>(); // magic and size have been looked at
        in_.integer<std::uint32_t>();
        log_.frameOrigin = in_.integer<std::uint64_t>();
        log_.software = in_.integer<std::uint8_t>() != 0;
        readNames();
        const auto records = in_.integer<std::uint32_t>();
        for (std::uint32_t i = 0; i < records && good(); ++i) {
            readRecord();
            if (!good() && fault_.empty())
                fault_ = "ends within record " + std::to_string(i + 1) + " of " + std::to_string(records);
        }
        if (good() && in_.left() != 0) fault_ = "has " + std::to_string(in_.left()) + " bytes too many";
        if (in_.failed && fault_.empty()) fault_ = "ends too early";
        if (!fault_.empty()) return Error{GN_ERROR_OUT_OF_RANGE, "BadDecisionLog", "decision log: " + fault_};
        return std::move(log_);
    }

private:
    bool good() const { return !in_.failed && fault_.empty(); }
    void fault(const std::string& text)
    {
        if (fault_.empty()) fault_ = text;
    }
    std::string text(std::size_t most) { return std::string(in_.text(most)); }

    void readNames()
    {
        const auto methods = in_.integer<std::uint8_t>();
        for (std::uint32_t i = 0; i < methods; ++i) {
            LoggedMethod method{.name = text(kMaxLogNameBytes)};
            method.traits = in_.integer<GnTraits>();
            method.unavailable = text(kMaxLogNameBytes);
            log_.methods.push_back(std::move(method));
        }
        const auto facts = in_.integer<std::uint8_t>();
        for (std::uint32_t i = 0; i < facts; ++i) {
            const std::string name = text(kMaxLogNameBytes);
            if (good() && (facts != kFactCount || name != kFactNames[i].name))
                return fault("has other facts than this version knows ('" + name + "')");
        }
        if (facts != kFactCount) return fault("has other facts than this version knows");
        log_.rulesName = text(kMaxLogNameBytes);
        log_.rulesText = text(kMaxLogRulesBytes);
        log_.preset = text(kMaxLogNameBytes);
        const auto lights = in_.integer<std::uint32_t>();
        if (lights > kMaxLogLights) return fault("names " + std::to_string(lights) + " lights");
        for (std::uint32_t i = 0; i < lights && good(); ++i) {
            const auto id = in_.integer<std::uint32_t>();
            log_.lights.push_back({id, text(kMaxLogNameBytes)});
        }
        const auto refusals = in_.integer<std::uint16_t>();
        for (std::uint32_t i = 0; i < refusals && good(); ++i)
            log_.refusals.push_back(text(kMaxLogNameBytes));
    }

    std::uint32_t readMethod(std::uint32_t methods)
    {
        const auto method = in_.integer<std::uint8_t>();
        if (method == kNoMethod) return UINT32_MAX;
        if (method >= methods) fault("names method " + std::to_string(method) + ", which it does not have");
        return method;
    }

    template <typename Enum>
    Enum readEnum(Enum last, const char* what)
    {
        const auto value = in_.integer<std::uint8_t>();
        if (value <= static_cast<std::uint8_t>(last)) return static_cast<Enum>(value);
        fault(std::string("has ") + what + " " + std::to_string(value) + ", which this version does not know");
        return Enum{};
    }

    void readRecord()
    {
        ReasonedHead head;
        head.frame = in_.integer<std::uint64_t>();
        if (head.frame < log_.frameOrigin) fault("has a frame before its origin");
        head.ruleHash = in_.integer<std::uint64_t>();
        head.knowledge = in_.integer<std::uint64_t>();
        head.lightId = in_.integer<std::uint32_t>();
        head.methods = in_.integer<std::uint8_t>();
        if (head.methods > log_.methods.size())
            fault("has " + std::to_string(head.methods) + " methods in a record, more than it names");
        for (std::uint32_t* method : {&head.method, &head.wanted, &head.incumbent, &head.pinned})
            *method = readMethod(head.methods);
        const auto fallbacks = in_.integer<std::uint8_t>();
        for (std::uint32_t i = 0; i < fallbacks && good(); ++i)
            if (const std::uint32_t method = readMethod(head.methods); method != UINT32_MAX) head.fallbacks.add(method);
        head.distanceAge = in_.integer<std::uint32_t>();
        head.reason = readEnum(GN_REASON_TRIAL, "reason");
        head.replan = readEnum(static_cast<Replan>(static_cast<int>(Replan::count) - 1), "cause");
        head.hold = readEnum(plan::Hold::trial, "hold");
        const auto flags = in_.integer<std::uint8_t>();
        head.budgeted = flags & kBudgeted, head.switched = flags & kSwitched;
        head.floor = flags & kFloor, head.floorUnmet = flags & kFloorUnmet;
        head.priced = flags & kPriced, head.guessed = flags & kGuessed;
        head.flatSource = flags & kFlatSource, head.asksHost = flags & kAsksHost;
        head.mapSide = in_.integer<std::uint16_t>();
        head.wantedSide = in_.integer<std::uint16_t>();
        head.redrawEvery = in_.integer<std::uint8_t>();
        head.mapAge = in_.integer<std::uint8_t>();
        for (float* value : floatsOf(head))
            *value = in_.real32();
        for (double& fact : head.facts)
            fact = in_.real64();
        const auto fired = in_.integer<std::uint8_t>();
        if (fired > kFiredRules) return fault("has " + std::to_string(fired) + " rules in a record");
        for (std::uint32_t i = 0; i < fired; ++i) {
            FiredRule& rule = head.fired[i];
            rule.rule = in_.integer<std::uint32_t>();
            rule.variable = in_.integer<std::uint32_t>();
            rule.term = in_.integer<std::uint32_t>();
            rule.strength = in_.real32(), rule.membership = in_.real32(), rule.weight = in_.real32();
        }
        for (std::uint32_t m = 0; m < head.methods && good(); ++m)
            readCandidate();
        log_.heads.push_back(head);
        log_.candidates.resize(log_.heads.size() * log_.methods.size()); // those added later
    }

    void readCandidate()
    {
        Candidate candidate;
        candidate.quantised = in_.integer<std::int16_t>();
        if (candidate.quantised < -1 || candidate.quantised > rules::kSuitabilitySteps)
            fault("has a suitability of " + std::to_string(candidate.quantised) + " / 4096");
        candidate.opinion = candidate.quantised >= 0;
        candidate.exclusion = readEnum(Exclusion::gpuPlaced, "exclusion");
        candidate.why = readEnum(plan::Why::price, "elimination");
        candidate.quality = in_.real32();
        candidate.predictedMs = in_.real32();
        candidate.sureMs = in_.real32();
        candidate.firstMs = in_.real32();
        candidate.sharedMs = in_.real32();
        if (candidate.exclusion != Exclusion::none) {
            candidate.detail = in_.integer<std::uint64_t>();
            const auto refusal = in_.integer<std::uint16_t>();
            if (refusal < log_.refusals.size()) candidate.refusal = log_.refusals[refusal].c_str();
        }
        log_.candidates.push_back(candidate);
    }

    ByteReader in_;
    DecisionLog log_;
    std::string fault_;
};

Error badLog(const std::string& text)
{
    return {GN_ERROR_OUT_OF_RANGE, "BadDecisionLog", "decision log: " + text};
}

} // namespace

Result<DecisionLog> readDecisionLog(std::string_view& bytes)
{
    if (!bytes.starts_with(kMagic.substr(0, kMagic.size() - 1))) return badLog("does not start as one");
    if (!bytes.starts_with(kMagic)) return badLog("is of another version");
    ByteReader head(bytes.substr(kMagic.size()));
    const auto size = head.integer<std::uint32_t>();
    constexpr std::size_t kLeast = 8 + 4 + 8 + 8;
    if (head.failed || size < kLeast || size > bytes.size())
        return badLog("is cut short: " + std::to_string(size) + " bytes announced, " + std::to_string(bytes.size()) +
                      " there");
    const std::string_view chunk = bytes.substr(0, size - sizeof(std::uint64_t));
    ByteReader hash(bytes.substr(chunk.size(), sizeof(std::uint64_t)));
    if (hash.integer<std::uint64_t>() != hashOfBytes(chunk)) return badLog("is damaged: its hash does not fit");
    bytes.remove_prefix(size);
    return ChunkReader(chunk).read();
}

} // namespace gnomon
