#include "runtime/select/methods.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "runtime/base/number_text.hpp"

namespace gnomon {

void Method::noteSettings()
{
    sideSetting_.reset();
    for (std::size_t i = 0; i < settings.size(); ++i)
        if (std::string_view(entry->settings[i].name) == "resolution") sideSetting_ = i;
    if (!followsCoverage()) return;
    const SettingSpec& spec = entry->settings[*sideSetting_];
    for (const std::uint32_t side : kMapSides) {
        std::vector<double>& at = atSides_[rungOf(side)];
        at = settings;
        at[*sideSetting_] = std::clamp(spec.standard * side / kUnmeasuredSide, spec.minimum, spec.maximum);
    }
}

MethodTable::MethodTable(const DeviceTable& vk, PipelineStore& pipelines, JobSystem& jobs, const Messages& messages,
                         bool background)
    : vk_(vk), pipelines_(pipelines), jobs_(jobs), messages_(messages), background_(background)
{
}

Error MethodTable::unknown(std::string_view name) const
{
    std::string text = "no method is named '" + std::string(name) + "'";
    for (const AbsentAlgorithm& algorithm : absent_)
        if (name == algorithm.name) text += "; this build is without " + std::string(algorithm.needs);
    return {GN_ERROR_UNKNOWN_METHOD, "UnknownMethod", text};
}

MethodSet MethodTable::fallbacks() const
{
    MethodSet set;
    for (const auto& method : methods_)
        if (method->has(GN_TRAIT_FALLBACK_BIT)) set.add(method->index);
    return set;
}

MethodTable::~MethodTable()
{
    finishBackground();
}

Result<void> MethodTable::addBuiltins(const AlgorithmRegistry& registry)
{
    for (const BuiltinAlgorithm& algorithm : registry.algorithms) {
        const bool onDevice = algorithm.entry->memoryWithDeviceRays && vk_.prefersRays;
        const AlgorithmEntry& entry =
            onDevice ? withDeviceRays_.emplace_back(algorithm.entry->withDeviceRays()) : *algorithm.entry;
        const Result<std::uint32_t> added = addEntry(entry);
        if (!added) return added.error();
        if (onDevice) methods_[*added]->onCpu = algorithm.entry;
    }
    absent_ = registry.absent;
    return {};
}

Result<std::uint32_t> MethodTable::addEntry(const AlgorithmEntry& entry)
{
    entries_.reserve(entries_.size() + 1);
    Result<std::uint32_t> added = add(entry.name, entry);
    if (added) entries_.push_back(&entry);
    return added;
}

Result<void> MethodTable::admits(std::string_view name) const
{
    if (find(name))
        return Error{GN_ERROR_OUT_OF_RANGE, "MethodExists",
                     "a method named '" + std::string(name) + "' exists already"};
    if (methods_.size() >= kMaxMethods)
        return Error{GN_ERROR_TOO_MANY, "TooManyMethods",
                     "method '" + std::string(name) + "' is one more than " + std::to_string(kMaxMethods)};
    return {};
}

Result<std::uint32_t> MethodTable::add(std::string_view name, const AlgorithmEntry& entry)
{
    if (Result<void> admitted = admits(name); !admitted) return admitted.error();
    auto method = std::make_unique<Method>();
    method->name = name;
    method->entry = &entry;
    method->index = static_cast<std::uint32_t>(methods_.size());
    for (const SettingSpec& spec : entry.settings) {
        const double value = spec.byCoverage ? 0.0 : spec.standard;
        method->settings.push_back(value);
        method->asked.push_back(false);
        method->settingInfos.push_back({spec.name, spec.description, spec.minimum, spec.maximum, value});
    }
    method->noteSettings();
    method->unavailable = entry.missing ? entry.missing(vk_) : nullptr;
    if (!method->unavailable) {
        pipelines_.setOwner(method->index);
        method->algorithm =
            entry.plugin ? entry.createPlugin(*entry.plugin) : entry.create({.vk = &vk_, .pipelines = &pipelines_});
    }
    methods_.push_back(std::move(method));
    ++revision_;
    return methods_.back()->index;
}

Result<const AlgorithmEntry*> MethodTable::algorithm(std::string_view name) const
{
    for (const AlgorithmEntry* entry : entries_)
        if (entry->name == name) return entry;
    return Error{GN_ERROR_UNKNOWN_METHOD, "UnknownAlgorithm", "no algorithm is named '" + std::string(name) + "'"};
}

Result<void> MethodTable::set(std::string_view name, std::string_view setting, double value, std::uint64_t frame)
{
    Method* method = find(name);
    if (!method) return unknown(name);
    for (std::size_t i = 0; i < method->entry->settings.size(); ++i) {
        const SettingSpec& spec = method->entry->settings[i];
        if (setting != spec.name) continue;
        const bool byCoverage = spec.byCoverage && value == 0.0;
        if (!byCoverage && !(value >= spec.minimum && value <= spec.maximum))
            return Error{std::isnan(value) ? GN_ERROR_NOT_A_NUMBER : GN_ERROR_OUT_OF_RANGE, "SettingOutOfRange",
                         std::string(name) + "." + spec.name + " is " + shortestText(value) + ", outside [" +
                             shortestText(spec.minimum) + ", " + shortestText(spec.maximum) + "]" +
                             (spec.byCoverage ? " and not 0" : "")};
        if (method->settings[i] != value) method->setAt = setAt_ = frame;
        change(*method, i, value);
        return {};
    }
    return Error{GN_ERROR_UNKNOWN_METHOD, "UnknownSetting",
                 "method '" + std::string(name) + "' has no setting '" + std::string(setting) + "'"};
}

void MethodTable::change(Method& method, std::size_t setting, double value) const
{
    std::vector<double> before;
    for (std::size_t i = 0; i < method.settings.size(); ++i)
        before.push_back(method.counted(i));
    const bool isNew = !method.asked[setting] || method.settings[setting] != value;
    method.asked[setting] = true;
    method.settings[setting] = method.settingInfos[setting].value = value;
    method.noteSettings();
    for (std::size_t i = 0; i < method.settings.size(); ++i) {
        const double used = method.counted(i);
        const bool changed = used != before[i] || (i == setting && isNew);
        if (!changed || !method.asked[i] || used == method.settings[i]) continue;
        messages_.warn("SettingClamped", method.name + "." + method.entry->settings[i].name + " is " +
                                             shortestText(method.settings[i]) + ", which counts as " +
                                             shortestText(static_cast<float>(used)) + " beside the other settings");
    }
}

Method* MethodTable::find(std::string_view name) const
{
    for (const auto& method : methods_)
        if (method->name == name) return method.get();
    return nullptr;
}

void MethodTable::createNow(Method& method)
{
    if (method.unavailable) return;
    while (pipelines_.createNext(method.index)) {
    }
}

bool MethodTable::failed(Method& method)
{
    const std::string failure = pipelines_.failure(method.index);
    if (!failure.empty()) fail(method, failure);
    return !failure.empty();
}

void MethodTable::fail(Method& method, const std::string& why)
{
    method.unavailable = "its pipelines could not be created";
    messages_.warn("MethodFailed", "method '" + method.name + "': " + why);
}

MethodTable::Step MethodTable::advance(Method& method)
{
    if (method.ready || method.unavailable) return Step::done;
    if (!method.warmUpStarted) {
        method.warmUpStarted = true;
        if (background_) {
            method.table = this;
            method.warmUp.data = &method;
            method.warmUp.run = [](void* data) {
                auto* self = static_cast<Method*>(data);
                self->table->createNow(*self);
            };
            jobs_.submit(method.warmUp);
            return Step::waits; // one method at a time
        }
        createNow(method);
    }
    if (background_ && !method.warmUp.done()) return Step::waits;
    return failed(method) ? Step::done : Step::created;
}

std::uint32_t MethodTable::nextWarmup(const MethodDemand& demand)
{
    const auto first = [&](auto&& belongs) -> std::optional<std::uint32_t> {
        for (auto& method : methods_) {
            if (!belongs(*method)) continue;
            const Step step = advance(*method);
            if (step != Step::done) return step == Step::created ? method->index : UINT32_MAX;
        }
        return std::nullopt;
    };
    if (const auto found = first([](const Method& method) { return method.has(GN_TRAIT_FALLBACK_BIT); })) return *found;
    if (const auto found = first([&](const Method& method) { return demand.pinned.has(method.index); })) return *found;
    if (!demand.others) return UINT32_MAX;
    const auto offered = [&](const Method& method) { return offered_.empty() || offered_.has(method.index); };
    return first(offered).value_or(UINT32_MAX);
}

void MethodTable::warnNotRecordable(std::uint32_t method, std::uint64_t roundTrips)
{
    Method& pinned = *methods_[method];
    if (std::exchange(pinned.saidNotRecordable, true)) return;
    messages_.warn("NotRecordable", "method '" + pinned.name +
                                        "', which a light is pinned to, needs the CPU between its "
                                        "passes (" +
                                        std::to_string(roundTrips) +
                                        " round trips), and the frame is recorded; the rules choose another for it");
}

void MethodTable::finishBackground()
{
    for (auto& method : methods_)
        if (method->warmUpStarted && background_) jobs_.wait(method->warmUp);
}

bool MethodTable::anyReady() const
{
    return std::any_of(methods_.begin(), methods_.end(), [](const auto& method) { return method->ready; });
}

} // namespace gnomon
