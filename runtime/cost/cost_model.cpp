#include "runtime/cost/cost_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/cost/exponent.hpp"

namespace gnomon::cost {

namespace {

constexpr double kLn2 = 0.6931471805599453;
constexpr double kNoise = 0.0123;      // log2(1.08)^2: 8 %, the timing noise usual for GPUs
constexpr double kSame = 0.5;          // octaves squared, of the device factor: the same, at another clock or load
constexpr double kAlike = 1.5;         // octaves squared: a device of the same kind
constexpr double kForeign = 9.0;       // octaves squared: any other
constexpr double kDeviceDrift = 1e-5;  // octaves squared a timed frame: a tenth of an octave in ten minutes
constexpr double kMethodDrift = 1e-4;  // octaves squared a timed frame: what a scene changes in a minute
constexpr double kStep = 0.15;         // octaves = 11 %: a median beyond it in 3 of 5 frames is a step of the device
constexpr double kLightShare = 0.5;    // of what a fit is off by, what lights of one scene differ by (rules/knowledge)
constexpr double kAmongRate = 0.1;     // ten lights say what the fit cannot
constexpr double kScaled = 0.25;       // octaves of doubt for each octave by which a light's workload has changed
constexpr double kFollow = 0.25;       // of the way to the middle of three timings
constexpr double kChanged = 1.0 / 64;  // octaves: 1 %, a change of what is expected of others
constexpr double kLeastMs = 1e-6;      // below what any clock tells
constexpr double kUnknown = 2.0;       // octaves: what nothing is known of
constexpr size_t kFrameTimings = 1024; // that are learned from

bool isTime(double ms)
{
    return std::isfinite(ms) && ms >= 0.0;
}

/// Of a method before teach(): 1 ms for a million pixels, or for 100 000 triangles, or for a million texels.
constexpr TrackCost kGuess{.ms = {0.1, 10.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}, .octaves = kUnknown, .samples = 1};

double square(double x)
{
    return x * x;
}

/// The middle of what there is, up to three; of two the lesser one: first timings are slow rather than fast.
double middleOf(std::array<double, 3> recent, uint32_t count)
{
    if (count < 3) return count == 1 ? recent[0] : std::min(recent[0], recent[1]);
    std::sort(recent.begin(), recent.end());
    return recent[1];
}

} // namespace

double Prediction::sureMs() const noexcept
{
    return ms * exp2Exactly(kSure * sigmaOctaves);
}

void CostModel::Belief::shift(double by) noexcept
{
    octaves += by;
    factor = exp2Exactly(octaves);
}

double Prediction::luckyMs(double sigmas) const noexcept
{
    return ms * exp2Exactly(-sigmas * ownOctaves);
}

/// @return the part of `error` that this is the reason for
double CostModel::Belief::take(double error, double otherVariance) noexcept
{
    const double share = variance / (variance + otherVariance);
    shift(share * error);
    variance -= share * variance;
    return share * error;
}

void CostModel::resize(uint32_t methods, uint32_t lights)
{
    const auto before = static_cast<uint32_t>(methods_.size());
    std::vector<Own> own(size_t{methods} * lights * 2);
    for (uint32_t light = 0; light < std::min(lights, lights_); ++light)
        for (uint32_t i = 0; i < std::min(methods, before) * 2; ++i)
            own[size_t{light} * methods * 2 + i] = own_[size_t{light} * before * 2 + i];
    surprises_.resize(kFrameTimings);
    votes_.resize(kFrameTimings);
    methods_.resize(methods);
    own_ = std::move(own);
    lights_ = lights;
    for (uint32_t m = before; m < methods; ++m)
        teach(m, {TrackCost{}, TrackCost{}, kGuess, TrackCost{}}, 0.0);
}

void CostModel::teach(uint32_t method, const std::array<TrackCost, kTracks>& tracks, double doubt) noexcept
{
    if (method >= methods_.size()) return;
    Method& known = methods_[method];
    known.tracks = tracks;
    known.timed = false;
    for (const Pass pass : {Pass::update, Pass::resolve}) {
        const auto p = static_cast<size_t>(pass);
        const double octaves =
            std::max(tracks[trackOf(pass, Processor::gpu)].octaves, tracks[trackOf(pass, Processor::cpu)].octaves);
        known.prior[p] = square(octaves) + square(doubt);
        known.scene[p] = {0.0, known.prior[p]};
        known.among[p] = square(kLightShare * octaves);
    }
    for (uint32_t light = 0; light < lights_; ++light)
        own(light, method, Pass::update) = own(light, method, Pass::resolve) = {};
    ++revision_;
}

void CostModel::setKinship(Kinship kinship) noexcept
{
    const double variance = kinship == Kinship::same ? kSame : kinship == Kinship::alike ? kAlike : kForeign;
    devices_.fill({0.0, variance});
    steps_ = {};
    ++revision_;
}

/// By the knowledge base and the device factors.
CostModel::Base CostModel::baseOf(const Method& method, Pass pass, const Workload& workload) const noexcept
{
    const Terms terms = termsOf(workload, pass);
    const auto msOn = [&](Processor processor) {
        const TrackCost& track = method.tracks[trackOf(pass, processor)];
        if (track.samples == 0) return 0.0;
        return sumOf(track.ms, terms) * devices_[at(static_cast<size_t>(processor))].factor;
    };
    const double gpuMs = msOn(Processor::gpu);
    return {gpuMs + msOn(Processor::cpu), gpuMs};
}

const CostModel::Own* CostModel::find(uint32_t light, uint32_t method, Pass pass) const noexcept
{
    if (light >= lights_) return nullptr;
    const Own& known = own_[(size_t{light} * methods_.size() + method) * 2 + static_cast<size_t>(pass)];
    return known.count > 0 ? &known : nullptr;
}

Prediction CostModel::predict(uint32_t light, uint32_t method, Pass pass, const Workload& workload) const noexcept
{
    if (method >= methods_.size()) return {};
    const Method& known = methods_[method];
    const Base base = baseOf(known, pass, workload);
    if (!(base.ms > 0.0)) return {}; // there is no such pass
    const auto p = static_cast<size_t>(pass);
    double factor = known.scene[p].factor, variance = 0.0, ownVariance = 0.0;
    Prediction out;
    if (const Own* timed = find(light, method, pass)) {
        factor *= exp2Exactly(timed->octaves);
        const double logBase = log2Exactly(std::max(base.ms, kLeastMs));
        variance = kNoise / std::min(timed->count, 4u) + square(kScaled * (logBase - timed->logBase));
        ownVariance = variance;
        out.measured = true;
    } else {
        const Belief& device = devices_[at(base.gpuMs > 0.5 * base.ms ? 0 : 1)];
        const double common = known.scene[p].variance + device.variance;
        variance = common + known.among[p] / std::max(1.0, workload.sharing);
        ownVariance = common + known.among[p];
    }
    out.ms = base.ms * factor;
    out.sigmaOctaves = std::sqrt(variance);
    out.sigmaMs = out.ms * kLn2 * out.sigmaOctaves; // d 2^x = ln 2 2^x dx
    out.ownOctaves = std::sqrt(ownVariance);
    return out;
}

Prediction CostModel::predict(uint32_t light, uint32_t method, const Workload& workload,
                              bool updateSkipped) const noexcept
{
    const Prediction resolve = predict(light, method, Pass::resolve, workload);
    const Prediction update = updateSkipped ? Prediction{} : predict(light, method, Pass::update, workload);
    const double redraws = 1.0 / workload.redrawEvery;
    Prediction sum{.ms = redraws * update.ms + resolve.ms,
                   .sigmaMs = redraws * update.sigmaMs + resolve.sigmaMs};
    sum.familiar = method < methods_.size() && methods_[method].timed;
    sum.measured = (update.measured || update.ms == 0.0) && (resolve.measured || resolve.ms == 0.0) && sum.ms > 0.0;
    if (sum.ms > 0.0) {
        sum.sigmaOctaves = sum.sigmaMs / (kLn2 * sum.ms);
        sum.ownOctaves = (redraws * update.ms * update.ownOctaves + resolve.ms * resolve.ownOctaves) / sum.ms;
    }
    return sum;
}

void CostModel::observe(const Observation& seen) noexcept
{
    if (seen.method >= methods_.size() || seen.light >= lights_ || !isTime(seen.gpuMs) || !isTime(seen.cpuMs)) return;
    if (seen.disturbed || seen.framesSinceSwitch < kSettleFrames || surpriseCount_ == surprises_.size()) return;
    const double ms = seen.gpuMs + seen.cpuMs;
    if (!(ms > kLeastMs)) return;
    Base base = baseOf(methods_[seen.method], seen.pass, seen.workload);
    if (!(base.ms > 0.0)) { // a pass that nobody knew of: as long for every workload, until lights show more
        const Processor on = seen.gpuMs > seen.cpuMs ? Processor::gpu : Processor::cpu;
        const double device = devices_[at(static_cast<size_t>(on))].factor;
        methods_[seen.method].tracks[trackOf(seen.pass, on)] = {.ms = {ms / device}, .octaves = kUnknown, .samples = 1};
        methods_[seen.method].scene[static_cast<size_t>(seen.pass)].variance = square(kUnknown);
        base = baseOf(methods_[seen.method], seen.pass, seen.workload);
    }
    const Prediction predicted = predict(seen.light, seen.method, seen.pass, seen.workload);
    surprises_[surpriseCount_++] = {.light = seen.light,
                                    .method = seen.method,
                                    .pass = seen.pass,
                                    .octaves = log2Exactly(ms / std::max(predicted.ms, kLeastMs)),
                                    .ms = predicted.ms,
                                    .base = log2Exactly(std::max(base.ms, kLeastMs)),
                                    .settled = predicted.measured,
                                    .onGpu = base.gpuMs > 0.5 * base.ms};
    methods_[seen.method].timed = true;
    ++samples_;
}

/// The frame's surprise on a processor: the middle of its timings by the time predicted, since what takes none says
/// nothing of the frame's. @param doubt the variance that methods and lights add to it
double CostModel::medianOf(size_t processor, bool settled, uint32_t& methods, double& doubt) noexcept
{
    uint32_t count = 0;
    methods = 0;
    double sum = 0.0;
    uint32_t newest = UINT32_MAX;
    for (uint32_t i = 0; i < surpriseCount_; ++i) {
        const Surprise& s = surprises_[i];
        if (at(s.onGpu ? 0 : 1) != processor || s.settled != settled) continue;
        votes_[count++] = {s.octaves, s.ms};
        const auto p = static_cast<size_t>(s.pass);
        sum += s.settled ? kNoise : methods_[s.method].scene[p].variance + methods_[s.method].among[p];
        if (s.method != newest) ++methods, newest = s.method;
    }
    if (count == 0) return 0.0;
    doubt = sum / count / std::max(1u, methods) + kNoise / count;
    return weightedMedian(std::span(votes_).first(count));
}

/// Lights that were timed keep what is predicted for them.
void CostModel::shiftKnown(size_t processor, double octaves) noexcept
{
    for (Own& each : own_) {
        if (each.count == 0 || at(each.onGpu ? 0 : 1) != processor) continue;
        each.octaves -= octaves;
        for (double& recent : each.recent)
            recent -= octaves;
    }
}

/// Lights whose times were known show steps. The others tell of the device as far as it is in doubt: a method that is
/// costlier than was thought says little of a device that is known.
void CostModel::learnDevice(size_t processor) noexcept
{
    Belief& device = devices_[processor];
    device.variance += kDeviceDrift;
    uint32_t methods = 0;
    double doubt = 0.0;
    const double known = medianOf(processor, true, methods, doubt);
    double taken = 0.0;
    if (methods > 0) {
        Steps& steps = steps_[processor];
        steps.medians[steps.next++ % steps.medians.size()] = known;
        std::array<double, 5> sorted = steps.medians; // empty places are 0
        std::nth_element(sorted.begin(), sorted.begin() + 2, sorted.end());
        if (std::fabs(sorted[2]) > kStep) {
            taken = sorted[2];
            device.shift(taken);
            steps = {};
            for (Own& each : own_) // what lights learned in those frames was the step
                each.recent.fill(each.octaves);
        }
    }
    const double unknown = medianOf(processor, false, methods, doubt) - taken;
    if (methods > 0) {
        const double part = device.take(unknown, doubt);
        shiftKnown(processor, part);
        taken += part;
    }
    if (std::fabs(taken) > kChanged) ++revision_;
    for (uint32_t i = 0; i < surpriseCount_; ++i)
        if (at(surprises_[i].onGpu ? 0 : 1) == processor) {
            surprises_[i].octaves -= taken;
            surprises_[i].base += taken;
        }
}

/// What is left is the methods': the middle of each one's lights that were not known, pass by pass.
void CostModel::learnMethods() noexcept
{
    for (uint32_t first = 0; first < surpriseCount_; ++first) {
        const Surprise& one = surprises_[first];
        const auto isOne = [&](const Surprise& s) { return s.method == one.method && s.pass == one.pass; };
        if (std::find_if(surprises_.begin(), surprises_.begin() + first, isOne) != surprises_.begin() + first) continue;
        const auto p = static_cast<size_t>(one.pass);
        Method& method = methods_[one.method];
        method.scene[p].variance = std::min(method.scene[p].variance + kMethodDrift, method.prior[p]);
        uint32_t count = 0;
        for (uint32_t i = first; i < surpriseCount_; ++i)
            if (isOne(surprises_[i]) && !surprises_[i].settled) votes_[count++] = {surprises_[i].octaves, 1.0};
        if (count == 0) continue;
        const double taken =
            method.scene[p].take(weightedMedian(std::span(votes_).first(count)), (method.among[p] + kNoise) / count);
        if (std::fabs(taken) > kChanged) ++revision_;
        for (uint32_t i = first; i < surpriseCount_; ++i)
            if (isOne(surprises_[i]) && !surprises_[i].settled) surprises_[i].octaves -= taken;
        // Lights that were known keep their times.
        for (uint32_t light = 0; light < lights_; ++light)
            if (Own& known = own(light, one.method, one.pass); known.count > 0) {
                known.octaves -= taken;
                for (double& recent : known.recent)
                    recent -= taken;
            }
    }
}

/// The middle of the newest three timings, followed a quarter of the way at a time.
void CostModel::learnLight(const Surprise& surprise) noexcept
{
    Own& known = own(surprise.light, surprise.method, surprise.pass);
    if (known.count == 0) { // how much this light differs from the method's others says how much others may
        double& among = methods_[surprise.method].among[static_cast<size_t>(surprise.pass)];
        among = std::max(kNoise, among + kAmongRate * (square(surprise.octaves) - among));
    }
    const double error = known.octaves + surprise.octaves;
    known.recent[known.count < 3 ? known.count : known.count % 3] = error;
    ++known.count;
    if (known.count > 3 + 3 * 3) known.count -= 3; // a place in `recent`, and more than three
    known.logBase = surprise.base;
    known.onGpu = surprise.onGpu;
    const double middle = middleOf(known.recent, known.count);
    known.octaves += (known.count <= 3 ? 1.0 : kFollow) * (middle - known.octaves);
}

void CostModel::endFrame() noexcept
{
    if (surpriseCount_ == 0) return;
    learnDevice(0);
    if (!sharedCores_) learnDevice(1);
    learnMethods();
    for (uint32_t i = 0; i < surpriseCount_; ++i)
        learnLight(surprises_[i]);
    surpriseCount_ = 0;
}

void CostModel::forgetLight(uint32_t light) noexcept
{
    if (light >= lights_) return;
    const size_t each = methods_.size() * 2;
    std::fill_n(own_.begin() + static_cast<std::ptrdiff_t>(light * each), each, Own{});
}

} // namespace gnomon::cost
