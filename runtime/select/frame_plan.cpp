#include "runtime/select/frame_plan.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string_view>
#include <utility>

#include "runtime/plan/utility.hpp"
#include "runtime/scene/light_pixels.hpp"
#include "runtime/scene/map_cover.hpp"
#include "runtime/scene/shadow_pixels.hpp"

namespace gnomon {

namespace {

// A prediction stands for so many frames, unless the light was timed or its workload left kSameShare of where it was.
// Timings come once in eight frames, so nothing newer is known in between.
constexpr std::uint64_t kPredictEvery = 8;
constexpr double kSameShare = 1.0 / 32.0; // 3 %: a time follows by less, and the model's own error is five times that

/// Reach::treeLevels until it is measured: the median of rules/knowledge/samples/lavapipe.csv.
constexpr double kTreeLevels = 5.4;
/// Of a ray that meets no caster: it asks the root at least. Small, so that it takes no time of its own.
constexpr double kLeastLevels = 0.01;

/// A light that rests keeps its static casters apart; then only the moving ones are drawn.
std::span<const Caster* const> drawnCasters(const SelectionInput& input)
{
    const bool apart = input.light->isStatic && !input.casters->dynamics.empty();
    return apart ? input.casters->dynamics : input.casters->all;
}

double drawnTriangles(const SelectionInput& input)
{
    const std::span<const Caster* const> drawn = drawnCasters(input);
    if (drawn.size() == input.casters->all.size()) return input.casters->triangles;
    double triangles = 0.0;
    for (const Caster* caster : drawn)
        if (caster->mesh) triangles += caster->mesh->triangleCount();
    return triangles;
}

/// @param light with the texels of a plain map of one face
cost::Workload workloadOf(const Method& method, const cost::Workload& light)
{
    cost::Workload workload = light;
    const double plain = light.mapTexels > 0.0 ? std::sqrt(light.mapTexels) : double{kUnmeasuredSide};
    const double side = method.mapSide(static_cast<std::uint32_t>(std::lround(plain)));
    workload.mapTexels = side * side * (light.point ? 6.0 : 1.0); // the faces of a cube
    if (!method.looksUpMaps()) workload.redrawEvery = 1.0;        // goes by what is now
    workload.still = light.still && (light.viewRests || !method.entry->followsView);
    if (!method.has(GN_TRAIT_TOPOLOGY_BIT)) workload.shadowPixels = 0.0; // draws no volumes
    if (!method.isSoft()) workload.softPixels = 0.0;
    const bool traces = method.has(GN_TRAIT_RAYS_BIT) || method.has(GN_TRAIT_DEVICE_RAYS_BIT);
    const bool tracesAll = traces && workload.mapTexels == 0.0; // a map answers most
    workload.treeLevels = tracesAll ? std::max(workload.treeLevels, kLeastLevels) : 0.0;
    return workload;
}

/// What asks every caster, and moves slowly: looked at again every few frames.
void addEstimates(cost::Workload& workload, const LightMemory& memory, const SelectionInput& input)
{
    constexpr std::uint64_t kEvery = 8; // frames
    const cost::Workload& before = memory.workload;
    const bool known = before.viewPixels > 0.0 && !input.view->cut;
    if (known && (input.frame + input.light->id) % kEvery != 0) {
        workload.shadowPixels = before.shadowPixels;
        workload.mapFilled = before.mapFilled;
        workload.mapTouched = before.mapTouched;
        return;
    }
    workload.shadowPixels = shadowPixels(*input.light, *input.casters, *input.view);
    const MapCover cover = mapCover(*input.light, *input.casters, drawnCasters(input));
    workload.mapFilled = cover.filled;
    workload.mapTouched = cover.touched;
}

bool isNear(double a, double b)
{
    return std::fabs(a - b) <= kSameShare * std::fabs(b);
}

/// Whether a prediction for the one still tells of the other.
bool isNear(const cost::Workload& a, const cost::Workload& b)
{
    return a.still == b.still && a.viewRests == b.viewRests && a.directional == b.directional && a.point == b.point &&
           isNear(a.pixels, b.pixels) && a.mapTexels == b.mapTexels && isNear(a.casterTriangles, b.casterTriangles) &&
           isNear(a.drawnTriangles, b.drawnTriangles) && isNear(a.casters, b.casters) &&
           isNear(a.drawnPixels, b.drawnPixels) && isNear(a.viewPixels, b.viewPixels) &&
           isNear(a.shadowPixels, b.shadowPixels) && isNear(a.softPixels, b.softPixels) &&
           isNear(a.mapFilled, b.mapFilled) && isNear(a.mapTouched, b.mapTouched) &&
           isNear(a.treeLevels, b.treeLevels) && a.redrawEvery == b.redrawEvery;
}

plan::Eligibility eligibilityOf(Exclusion exclusion)
{
    if (exclusion == Exclusion::none) return plan::Eligibility::eligible;
    return exclusion == Exclusion::vetoed ? plan::Eligibility::never : plan::Eligibility::trait;
}

} // namespace

void FramePlan::begin()
{
    requests_.clear();
}

std::uint32_t FramePlan::slotOf(LightMemory& memory)
{
    if (memory.costSlot != UINT32_MAX) return memory.costSlot;
    if (freeSlots_.empty()) {
        if (slotsUsed_ == slots_) growModel(std::max(16u, slots_ * 2));
        memory.costSlot = slotsUsed_++;
    } else {
        memory.costSlot = freeSlots_.back();
        freeSlots_.pop_back();
        histories_[memory.costSlot] = {};
    }
    return memory.costSlot;
}

/// To the methods there are and so many slots; new methods learn from the knowledge base.
void FramePlan::growModel(std::uint32_t slots)
{
    freeSlots_.reserve(slots); // so that forget() needs no memory
    model_.resize(methods_.size(), slots);
    histories_.resize(slots);
    measure(slots);
    slots_ = slots; // last: where memory ends before, the next light tries again
    if (modelMethods_ < methods_.size() && known_) cost::teach(model_, *known_, algorithms(), modelMethods_);
    modelMethods_ = methods_.size();
}

/// Quality and first frame of every method, by the knowledge base; all predictions are out of date.
void FramePlan::measure(std::uint32_t slots)
{
    std::vector<cost::MethodMeasures> measures;
    for (std::uint32_t i = 0; i < methods_.size(); ++i)
        measures.push_back(cost::measuresOf(knowledge_, known_, methods_[i].entry->name,
                                            double{methods_[i].entry->typicalWrongPercent}));
    wrong_.resize(kMapSides.size() * methods_.size());
    costs_.assign(std::size_t{slots} * methods_.size(), {});
    measures_ = std::move(measures);
    for (SlotHistory& history : histories_)
        history.predictedAt = kNever;
}

std::vector<cost::TaughtMethod> FramePlan::algorithms() const
{
    // What a method works with says what it costs like; the kinds of light that it serves do not.
    constexpr GnTraits kWork =
        GN_TRAIT_RAYS_BIT | GN_TRAIT_TOPOLOGY_BIT | GN_TRAIT_SOFT_PENUMBRA_BIT | GN_TRAIT_DEVICE_RAYS_BIT;
    std::vector<cost::TaughtMethod> all;
    for (std::uint32_t i = 0; i < methods_.size(); ++i) {
        const AlgorithmEntry& entry = *methods_[i].entry;
        const std::uint64_t map = methods_[i].mapSide(kUnmeasuredSide) > 0.0, waits = entry.roundTrips > 0;
        all.push_back({entry.name, std::uint64_t{entry.traits & kWork} << 2 | map << 1 | waits});
    }
    return all;
}

FramePlan::Taught FramePlan::teach(cost::KnowledgeBase base, const Device& device)
{
    const cost::DeviceKnowledge* nearest = base.nearestTo(device.name, device.kind);
    if (!nearest) return {};
    cost::CostModel fresh;
    fresh.setSharedCores(sharedCores_);
    fresh.resize(methods_.size(), slots_);
    Taught taught{.methods = cost::teach(fresh, *nearest, algorithms()),
                  .device = nearest->device,
                  .same = nearest->device == device.name};
    if (taught.methods == 0) return taught;
    fresh.setKinship(taught.same                    ? cost::Kinship::same
                     : nearest->kind == device.kind ? cost::Kinship::alike
                                                    : cost::Kinship::foreign);
    const auto place = nearest - base.devices.data();
    model_ = std::move(fresh);
    knowledge_ = std::move(base);
    known_ = knowledge_.devices.data() + place;
    modelMethods_ = methods_.size();
    histories_.resize(slots_);
    measure(slots_);
    return taught;
}

const TimedLight* FramePlan::timed(const LightMemory& memory) const
{
    if (memory.costSlot >= histories_.size()) return nullptr;
    const TimedLight& timed = histories_[memory.costSlot].timed;
    return timed.timing.frame ? &timed : nullptr;
}

bool FramePlan::isTimed(const LightMemory& memory, std::uint32_t method) const
{
    return memory.costSlot < slots_ && method < methods_.size() && costs_[cellOf(memory, method)].steady.measured;
}

void FramePlan::forget(LightMemory& memory)
{
    if (memory.costSlot == UINT32_MAX) return;
    model_.forgetLight(memory.costSlot);
    freeSlots_.push_back(std::exchange(memory.costSlot, UINT32_MAX));
}

void FramePlan::add(LightDecision& decision, LightMemory& memory, const SelectionInput& input)
{
    slotOf(memory);
    const VkExtent2D drawn = input.view->area.extent;
    const double all = 1.0 * drawn.width * drawn.height;
    const VkExtent2D around = lightPixels(*input.light, *input.view).extent;
    const double rectangle = 1.0 * around.width * around.height;
    const double reached = shareOf(memory, *input.view, *input.light) * all;
    cost::Workload workload{.pixels = reached,
                            .casterTriangles = static_cast<double>(input.casters->triangles),
                            .mapTexels = 1.0 * input.plainSide * input.plainSide,
                            .still = input.still,
                            .drawnTriangles = drawnTriangles(input),
                            .casters = static_cast<double>(input.casters->all.size()),
                            .directional = input.light->type == GN_LIGHT_TYPE_DIRECTIONAL,
                            .point = input.light->type == GN_LIGHT_TYPE_POINT,
                            .drawnPixels = rectangle,
                            .viewPixels = all,
                            .softPixels = input.light->constants.sourceRadius > 0.0f ? reached : 0.0,
                            .treeLevels = memory.measured ? memory.treeLevels.get() : kTreeLevels,
                            .viewRests = input.viewRests,
                            .redrawEvery = static_cast<double>(std::max(memory.redrawEvery, 1u))};
    addEstimates(workload, memory, input);
    memory.workload = workload;
    requests_.push_back({&decision, &memory, input.pinned, input.importance, drawn.height, input.mostPlainSide});
}

/// What every method would take for a light, looked up or asked again. Lights take turns, so that no frame asks for
/// all.
std::span<const FramePlan::Cost> FramePlan::predict(const LightMemory& memory, std::uint64_t frame)
{
    const std::uint32_t methods = methods_.size();
    SlotHistory& history = histories_[memory.costSlot];
    const std::span costs = std::span(costs_).subspan(std::size_t{memory.costSlot} * methods, methods);
    const bool due = (frame + memory.costSlot) % kPredictEvery == 0 || frame - history.predictedAt >= kPredictEvery;
    const bool sameSettings = history.predictedAt > methods_.setAt();
    if (history.predictedAt != kNever && !due && sameSettings && history.predictedRevision == model_.revision() &&
        isNear(memory.workload, history.predictedFor))
        return costs;
    for (std::uint32_t m = 0; m < methods; ++m) {
        cost::Workload workload = workloadOf(methods_[m], memory.workload);
        if (budgeted_) workload.sharing = 1.0; // within a budget every light has to be sure
        const auto of = [&](cost::Pass pass) { return model_.predict(memory.costSlot, m, pass, workload); };
        const cost::Prediction steady = model_.predict(memory.costSlot, m, workload, workload.still);
        // What stands still is drawn once, in the first frame, and so is most of what the view comes to see.
        costs[m] = {.steady = steady,
                    .sureMs = steady.measured ? steady.ms : steady.sureMs(),
                    .firstMs =
                        std::max(measures_[m].firstFrameMs, memory.workload.still ? of(cost::Pass::update).ms : 0.0)};
    }
    history.predictedAt = frame;
    history.predictedRevision = model_.revision();
    history.predictedFor = memory.workload;
    return costs;
}

/// What a light's incumbent takes while another method fades in; nothing where both show the same.
double FramePlan::fadeMs(const rules::RuleBase* base, std::uint32_t own, std::uint32_t method,
                         std::span<const Cost> costs) const
{
    if (!base || own >= methods_.size() || own == method) return 0.0;
    if (methods_[own].isExact() && methods_[method].isExact()) return 0.0;
    return costs[own].steady.ms * static_cast<double>(base->policy.hysteresis.crossFadeFrames);
}

/// Candidates and requests of the plan step, and the prediction of every decision.
void FramePlan::fill(const rules::RuleBase* base, const Budget& budget)
{
    const std::uint32_t methods = methods_.size();
    if (modelMethods_ != methods) growModel(slots_);
    requestLights(base, budget);
    candidates_.resize(requests_.size() * methods);
    sharesMs_.resize(methods);
    for (std::uint32_t m = 0; m < methods; ++m) {
        for (const std::uint32_t side : kMapSides)
            wrong_[rungOf(side) * methods + m] = static_cast<float>(measures_[m].wrongAt(methods_[m].mapSide(side)));
        sharesMs_[m] =
            static_cast<float>(plan::partsMs(budget.parts, MethodSet{m}) / static_cast<double>(requests_.size()));
    }
    for (std::size_t i = 0; i < requests_.size(); ++i) {
        const Request& request = requests_[i];
        LightMemory& memory = *request.memory;
        memory.workload.sharing = static_cast<double>(requests_.size());
        SlotHistory& history = histories_[memory.costSlot];
        history.recent[budget.frame % history.recent.size()] = {budget.frame, memory.workload};
        memory.plan.incumbent = memory.incumbent;
        const Coarseness& coarseness = request.coarseness;
        memory.nearSide = lights_[i].floor && request.pinned == UINT32_MAX
                              ? leastSide(request.decision->method, lights_[i].minimumQuality, coarseness)
                              : 0;
        const std::span<const Cost> costs = predict(memory, budget.frame);
        // A map that is drawn and too coarse grows in the next frames, as far as memory allows. One that would be drawn
        // now has the side that it has now; where it is too coarse, that grows before the light changes to it.
        const bool draws = memory.incumbent < methods && methods_[memory.incumbent].followsCoverage();
        const std::uint32_t grown = draws ? std::min(memory.nearSide, request.mostSide) : 0;
        const std::uint32_t side = std::max(request.decision->plainSide, grown);
        for (std::uint32_t m = 0; m < methods; ++m) {
            Candidate& from = request.decision->candidates[m];
            const cost::Prediction& cost = costs[m].steady;
            candidates_[i * methods + m] = {.eligibility = eligibilityOf(from.exclusion),
                                            .suitability = from.quantised,
                                            .quality = quality(m, side, coarseness),
                                            .ms = costs[m].sureMs,
                                            .likelyMs = cost.ms,
                                            .sigmaMs = cost.measured ? cost.sigmaMs : 0.0,
                                            .firstFrameMs = costs[m].firstMs,
                                            .familiar = cost.familiar};
            from.quality = candidates_[i * methods + m].quality;
            from.predictedMs = static_cast<float>(cost.ms);
            from.sureMs = static_cast<float>(costs[m].sureMs);
            // The plan has no say in fades, nor they in the plan.
            const double fadingMs = budgeted_ ? 0.0 : fadeMs(base, memory.incumbent, m, costs);
            from.firstMs = static_cast<float>(costs[m].firstMs + fadingMs);
            from.sharedMs = sharesMs_[m];
        }
    }
}

plan::PlanReport FramePlan::decide(const rules::RuleBase* base, const Budget& budget)
{
    probe_ = {};
    if (requests_.empty()) return {};
    const bool budgeted = budgeted_ = countsTime(base) && budget.ms > 0.0;
    fill(base, budget);
    plan::PlanReport report;
    if (budgeted) {
        // Grows with the number of lights, in powers of two: a steady frame allocates nothing.
        plan_.reserve(std::bit_ceil(static_cast<std::uint32_t>(requests_.size())), methods_.size());
        const plan::PlanInput input{.frame = budget.frame,
                                    .lights = lights_,
                                    .candidates = candidates_,
                                    .parts = budget.parts,
                                    .methods = methods_.size(),
                                    .budgetMs = budget.ms,
                                    .perCheapest = budget.perCheapest,
                                    .sharedMs = budget.sharedMs,
                                    .measuredMs = budget.measuredMs,
                                    .cut = budget.cut,
                                    .policy = &base->policy};
        report = plan_.step(input);
        if (budget.probe)
            probe_ = plan::chooseProbe(input, plan_, report,
                                       {.sigmas = base->policy.probing.sigma,
                                        .frames = double{cost::kLearnFrames},
                                        .lastSecondMs = budget.lastSecondMs});
        for (std::size_t i = 0; i < requests_.size(); ++i) {
            LightDecision& decision = *requests_[i].decision;
            const auto light = static_cast<std::uint32_t>(i);
            for (std::uint32_t m = 0; m < methods_.size(); ++m) {
                decision.candidates[m].why = plan_.why(light)[m];
                decision.candidates[m].sharedMs = static_cast<float>(plan_.sharedMs(light, m));
            }
            takePlan(plan_.lights()[i], decision);
        }
    } else {
        for (const Request& request : requests_) {
            const std::span all = std::span<const Candidate>(request.decision->candidates).first(methods_.size());
            report.cheapestMs += double{cheapestMs(all, request.pinned)};
        }
        if (countsTime(base)) economise(base->policy, budget);
        for (const Request& request : requests_)
            explainWithoutPlan(request, base != nullptr);
    }
    for (std::size_t i = 0; i < requests_.size(); ++i) {
        LightDecision& decision = *requests_[i].decision;
        if (decision.floor) decision.minimumQuality = requests_[i].memory->plan.nearQuality;
        if (decision.method != UINT32_MAX) decision.predictedMs = decision.candidates[decision.method].predictedMs;
    }
    return report;
}

void FramePlan::observe(LightMemory& memory, std::uint32_t method, const LightTiming& timing, bool disturbed)
{
    if (method >= methods_.size() || modelMethods_ != methods_.size()) return;
    if (timing.frame <= methods_[method].setAt) return; // with other settings
    const std::uint32_t slot = slotOf(memory);
    SlotHistory& history = histories_[slot];
    const SlotHistory::Entry& then = history.recent[timing.frame % history.recent.size()];
    const cost::Workload workload =
        workloadOf(methods_[method], then.frame == timing.frame ? then.workload : memory.workload);
    history.timed = {timing, method, workload};
    history.predictedAt = kNever; // this light is known better now
    // A method on its way out teaches nothing, nor does it age the one that serves.
    const bool probed = method == memory.probed && timing.frame < memory.probedSince + cost::kLearnFrames;
    const std::uint64_t since = method == memory.incumbent ? memory.methodSince
                                : probed                   ? memory.probedSince
                                                           : timing.frame;
    cost::Observation seen{.light = slot,
                           .method = method,
                           .workload = workload,
                           .framesSinceSwitch = timing.frame > since ? timing.frame - since : 0,
                           .disturbed = disturbed};
    if (timing.updated) {
        seen.pass = cost::Pass::update;
        seen.gpuMs = double{timing.updateGpuMs}, seen.cpuMs = double{timing.updateCpuMs};
        model_.observe(seen);
    }
    seen.pass = cost::Pass::resolve;
    seen.gpuMs = double{timing.resolveGpuMs}, seen.cpuMs = double{timing.resolveCpuMs};
    model_.observe(seen);
}

} // namespace gnomon
