#include "runtime/cost/cost_model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/cost/exponent.hpp"

namespace gnomon::cost {

namespace {

// Sizes at which the features are zero: one million pixels, 16 384 triangles, a 1024 x 1024 map. Any would do; near the
// middle of what occurs the constant and the slopes are least entangled.
constexpr double kPixelsReference = 20.0;
constexpr double kTrianglesReference = 14.0;
constexpr double kTexelsReference = 20.0;
constexpr double kCastersReference = 4.0;
constexpr double kFewTriangles = 500.0;    // drawn in the time that an empty pass takes
constexpr double kClearShare = 1.0 / 32.0; // of a pixel's shading: what clearing one costs
// A pixel that a side of a volume covers (scene/shadow_pixels.cpp) takes this share of the time of one that is
// resolved. This constant and the next two are fits to rows of `gnomon calibrate`. Rows that are left out are predicted
// with 0.344 and 0.382 octaves rms for two methods with volumes; with half of it 0.358 and 0.389, with twice 0.338 and
// 0.383.
constexpr double kSideShare = 1.0 / 4.0;
// A level of a caster's tree on a ray's way takes this share of what reading a receiver takes. Two methods by rays:
// 0.243 and 0.384; with half of it 0.247 and 0.386, with twice 0.245 and 0.385.
constexpr double kLevelShare = 0.28;
// So many texels that casters fill (scene/map_cover.hpp) take as long as drawing one triangle more, be it to fill them
// or because a method cuts what is large on its map. Updates of seven methods with maps: 0.372; with 16 and with 256
// texels 0.378 and 0.375, with the filled texels' logarithm for a feature 0.391, without any 0.394.
constexpr double kTexelsATriangle = 64.0;
constexpr double kOneFace = 1.0 / 6.0; // of a cube, the least that an update draws
constexpr double kBend = 1.0 / 8.0;    // products reach the size of the logarithms at 8 octaves from the reference

constexpr double kForgetting = 0.999;   // remembers about 1000 timings of a workload, some seconds of frames
constexpr double kClip = 0.25;          // octaves. A spike of x4 moves the fit no more than one of x1.19
constexpr double kSlopeVariance = 0.25; // prior: slopes are within 0.5 of the guess
constexpr double kConstantVariance = 4; // prior: within 2 octaves, a factor of 4
constexpr double kStartNoise = 0.0123;  // log2(1.08)^2: 8 %, the timing noise usual for GPUs
constexpr double kStartLights = 0.04; // (0.2 octaves)^2: a light differs from the fit by 15 %, until lights have shown
constexpr double kLeastNoise = 1e-4;  // 0.7 %: timers are no better
constexpr double kLightsRate = 0.002; // of the variance among lights: some seconds of timings
constexpr double kNoiseRate = 0.02;   // smoothing of the noise over 50 timings
constexpr double kForeignVariance = 1.0; // of the device factor of a foreign calibration: within a factor of 2

constexpr double kResidualBlend = 8.0; // n / (n + 8): the residual has half its weight after 8 timings
constexpr double kSceneBlend = 1.0;    // lights of a scene have as much in common as they differ by
constexpr double kResidualMost = 32.0; // effective timings: new ones always count for 1/32 at least
constexpr double kPersistent = 0.25;   // octaves. Four timings in a row beyond it on one side are a step, no spikes;
                                       // one more than a step of the device needs, which therefore comes first
constexpr uint32_t kDeviceFrames = 10; // the device factor is learned first, in so many frames
constexpr double kDeviceStep = 0.15;   // octaves = 11 %: a median beyond it in 3 of 5 frames is a step of the device
constexpr size_t kFrameVotes = 1024;   // timings of a frame that vote on the device factor

/// What is guessed of a method nobody has measured: 1 ms for the reference workload, updates growing with triangles and
/// texels, resolves with pixels.
Features priorOf(uint32_t track)
{
    if (track / 2 == static_cast<uint32_t>(Pass::update)) return {0.0, 0.5, 0.5};
    return {0.0, 0.5, 0.0, 0.0, 0.5};
}

double logOf(double size)
{
    return log2Exactly(std::isfinite(size) && size > 1.0 ? size : 1.0);
}

bool isTime(double ms)
{
    return std::isfinite(ms) && ms > 0.0;
}

} // namespace

Features featuresOf(const Workload& workload, Pass pass) noexcept
{
    // Small sizes vanish in what is there anyway (a clear, a submit): they are added before the logarithm.
    const double touched = pass == Pass::update ? std::max(workload.mapTouched, kOneFace) : 1.0;
    const double texels = workload.mapTexels > 0.0 ? logOf(touched * workload.mapTexels) - kTexelsReference : 0.0;
    const double casters = logOf(workload.casters) - kCastersReference;
    if (pass == Pass::update) {
        const double drawn = workload.drawnTriangles > 0.0 ? workload.drawnTriangles : workload.casterTriangles;
        const double triangles = logOf(drawn + kFewTriangles) - kTrianglesReference;
        return {1.0,
                triangles,
                texels,
                casters,
                drawn < workload.casterTriangles ? 1.0 : 0.0,
                workload.directional ? 1.0 : 0.0,
                logOf(drawn + kFewTriangles + workload.mapFilled * workload.mapTexels / kTexelsATriangle) -
                    kTrianglesReference,
                triangles * triangles * kBend,
                triangles * texels * kBend,
                texels * texels * kBend};
    }
    const double view = workload.viewPixels > 0.0 ? workload.viewPixels : workload.pixels;
    const double around = workload.drawnPixels > 0.0 ? workload.drawnPixels : workload.pixels;
    const double triangles = logOf(workload.casterTriangles + kFewTriangles) - kTrianglesReference;
    const double pixels = logOf(workload.pixels + kClearShare * view) - kPixelsReference;
    const double rectangle = logOf(around + kClearShare * view) - kPixelsReference;
    return {1.0,
            pixels,
            triangles,
            workload.mapTexels > 0.0 ? texels : casters,
            rectangle,
            logOf(around + kSideShare * workload.shadowPixels + kLevelShare * workload.treeLevels * workload.pixels +
                  kClearShare * view) -
                kPixelsReference,
            workload.directional ? 1.0 : 0.0,
            workload.point ? 1.0 : 0.0,
            triangles * triangles * kBend,
            triangles * pixels * kBend};
}

void CostModel::reset(Track& track, uint32_t t) noexcept
{
    track = {};
    track.theta = priorOf(t);
    track.noise = kStartNoise;
    track.lights = kStartLights;
    // In units of the noise, so that the prior weighs in octaves.
    for (uint32_t i = 0; i < kFeatures; ++i)
        track.covariance[i * kFeatures + i] = (i == 0 ? kConstantVariance : kSlopeVariance) / kStartNoise;
}

void CostModel::resize(uint32_t methods, uint32_t lights)
{
    std::vector<Residual> residuals(size_t{methods} * lights * kTracks);
    for (uint32_t light = 0; light < std::min(lights, lights_); ++light)
        for (uint32_t i = 0; i < std::min(methods, methods_) * kTracks; ++i)
            residuals[size_t{light} * methods * kTracks + i] = residuals_[size_t{light} * methods_ * kTracks + i];
    residuals_ = std::move(residuals);
    const uint32_t known = std::min(methods, methods_) * kTracks;
    tracks_.resize(size_t{methods} * kTracks);
    for (uint32_t i = known; i < tracks_.size(); ++i)
        reset(tracks_[i], i % kTracks);
    for (Device& device : devices_)
        device.votes.resize(kFrameVotes);
    methods_ = methods;
    lights_ = lights;
}

/// One step of recursive least squares with the given error; returns the variance of its prediction in units of noise.
/// What is forgotten is forgotten along `f` alone (restricted forgetting: R. Kulhavy, "Restricted exponential
/// forgetting in real-time identification", Automatica 23, 1987): a thousand timings of one workload say nothing of
/// others, and make what was known of them no less certain. With `forgetting` 1 it is ordinary least squares.
double CostModel::fit(Track& track, const Features& f, double error, double forgetting) noexcept
{
    Features pf{};
    double fpf = 0.0;
    for (uint32_t i = 0; i < kFeatures; ++i) {
        for (uint32_t j = 0; j < kFeatures; ++j)
            pf[i] += track.covariance[i * kFeatures + j] * f[j];
        fpf += f[i] * pf[i];
    }
    if (!(fpf > 0.0)) return 0.0; // nothing left to learn in that direction
    const double gain = 1.0 / (1.0 + fpf);
    // The information gained along f, less what is forgotten of it. fpf settles where the two are equal, at
    // (1 - forgetting) / forgetting. The covariance stays positive: gained * fpf > -1.
    const double gained = forgetting - (1.0 - forgetting) / fpf;
    const double shrink = gained * gain / forgetting;
    for (uint32_t i = 0; i < kFeatures; ++i) {
        track.theta[i] += pf[i] * gain * error;
        for (uint32_t j = 0; j < kFeatures; ++j)
            track.covariance[i * kFeatures + j] -= pf[i] * pf[j] * shrink;
    }
    return fpf;
}

void CostModel::calibrate(uint32_t method, Pass pass, Processor processor, const Workload& workload, double ms) noexcept
{
    if (method >= methods_ || !isTime(ms)) return;
    Track& known = track(method, trackOf(pass, processor));
    const Features f = featuresOf(workload, pass);
    double error = log2Exactly(ms);
    for (uint32_t i = 0; i < kFeatures; ++i)
        error -= known.theta[i] * f[i];
    const double spread = fit(known, f, error, 1.0);
    // The error has variance noise (1 + spread); the first ones tell of the prior only.
    if (known.samples >= kFeatures)
        known.noise = std::max(kLeastNoise, known.noise + (error * error / (1.0 + spread) - known.noise) /
                                                              (known.samples - kFeatures + 2.0));
    ++known.samples;
    known.seen = true;
    ++samples_;
}

void CostModel::finishCalibration(bool sameDevice) noexcept
{
    for (Device& device : devices_) {
        device.octaves = 0.0;
        device.frames = sameDevice ? kDeviceFrames : 0;
        device.variance = sameDevice ? 0.0 : kForeignVariance;
    }
    // Every place of a calibration is another light: what the fit leaves over there is how much lights differ.
    for (Track& known : tracks_)
        if (known.samples >= kFeatures) known.lights = std::max(kStartLights, known.noise);
}

CostModel::Octaves CostModel::octaves(uint32_t light, uint32_t method, uint32_t t, const Features& f) const noexcept
{
    const Track& known = track(method, t);
    // Row by row: the sums of all features grow side by side. The covariance is symmetric to the last bit.
    Features pf{};
    for (uint32_t j = 0; j < kFeatures; ++j)
        for (uint32_t i = 0; i < kFeatures; ++i)
            pf[i] += known.covariance[j * kFeatures + i] * f[j];
    const Device& device = deviceOf(t);
    double mean = device.octaves, spread = 0.0;
    for (uint32_t i = 0; i < kFeatures; ++i) {
        mean += known.theta[i] * f[i];
        spread += f[i] * pf[i];
    }
    double variance = std::max(known.noise, kStartNoise) * spread + device.variance;
    mean += known.scene;
    if (light < lights_) {
        const Residual& own = residuals_[(size_t{light} * methods_ + method) * kTracks + t];
        const double weight = trust(known, effectiveSamples(own, f));
        mean += weight * (own.octaves - known.scene);
        variance += known.lights * (1.0 - weight);
    }
    return {mean, variance, known.samples >= kFeatures};
}

double CostModel::effectiveSamples(const Residual& own, const Features& f) noexcept
{
    double distance = 0.0;
    for (uint32_t i = 0; i < kFeatures; ++i)
        distance += std::fabs(f[i] - own.at[i]);
    return own.samples / (1.0 + distance); // what was learned elsewhere counts for less
}

/// Weight of a light's own timings. The more lights differ by this method, the more its first ones tell.
double CostModel::trust(const Track& known, double samples) const noexcept
{
    return samples / (samples + kResidualBlend * std::min(1.0, kStartLights / known.lights));
}

/// The mean of what its lights differ by, drawn towards nothing while they are few.
void CostModel::noteScene(uint32_t method, uint32_t t) noexcept
{
    Track& known = track(method, t);
    double sum = 0.0, weights = kSceneBlend;
    for (uint32_t light = 0; light < lights_; ++light) {
        const Residual& own = residual(light, method, t);
        const double weight = trust(known, own.samples);
        sum += weight * own.octaves;
        weights += weight;
    }
    known.scene = sum / weights;
}

/// Running mean of what the fit leaves over for this light, with clipped errors; four alike in a row replace it.
void CostModel::learn(Residual& own, const Features& f, double error) noexcept
{
    own.samples = effectiveSamples(own, f);
    own.at = f;
    own.recent[own.recentNext] = error;
    own.recentNext = static_cast<uint8_t>((own.recentNext + 1) % own.recent.size());
    own.recentCount = static_cast<uint8_t>(std::min<size_t>(own.recentCount + 1u, own.recent.size()));
    if (own.recentCount == own.recent.size()) {
        auto sorted = own.recent;
        std::sort(sorted.begin(), sorted.end());
        const double low = sorted.front() - own.octaves, high = sorted.back() - own.octaves;
        if (low > kPersistent || high < -kPersistent) {
            own.octaves = 0.5 * (sorted[1] + sorted[2]);
            own.samples = kResidualMost;
            return;
        }
    }
    own.samples = std::min(own.samples + 1.0, kResidualMost);
    const double change = std::clamp(error - own.octaves, -kClip, kClip);
    own.octaves += change / own.samples;
}

void CostModel::observe(const Observation& observation) noexcept
{
    if (observation.method >= methods_ || observation.light >= lights_ || !isTime(observation.ms)) return;
    if (observation.disturbed || observation.framesSinceSwitch < kSettleFrames) return;
    const uint32_t t = trackOf(observation.pass, observation.processor);
    const Features f = featuresOf(observation.workload, observation.pass);
    Track& known = track(observation.method, t);
    const double y = log2Exactly(observation.ms);
    const double predicted = octaves(observation.light, observation.method, t, f).mean;
    const double surprise = y - predicted;
    const bool votes = known.samples >= kFeatures; // a guess says nothing about the device
    Device& device = deviceOf(t);
    if (votes)
        noteVote(device, {surprise, exp2Exactly(predicted)}, observation.method,
                 isSettled(residual(observation.light, observation.method, t), f));
    ++samples_;
    // Device first: until it is known every method looks wrong by the same factor, and nothing else is learned.
    if (device.frames < kDeviceFrames && votes) {
        known.seen = true;
        return;
    }
    double error = y - device.octaves, spread = 0.0;
    for (uint32_t i = 0; i < kFeatures; ++i) {
        error -= known.theta[i] * f[i];
        for (uint32_t j = 0; j < kFeatures; ++j)
            spread += f[i] * known.covariance[i * kFeatures + j] * f[j];
    }
    Residual& own = residual(observation.light, observation.method, t);
    learn(own, f, error);
    known.timed = true;
    if (own.samples >= kResidualBlend) known.lights += (own.octaves * own.octaves - known.lights) * kLightsRate;
    // While the fit is a guess a large error is what one expects; the clip narrows as it becomes sure.
    const double clip = std::max(kClip, 2.0 * std::sqrt(known.noise * spread));
    const double clipped = std::clamp(error, -clip, clip);
    fit(known, f, clipped, kForgetting);
    const double square = std::clamp(surprise, -kClip, kClip) * std::clamp(surprise, -kClip, kClip);
    if (known.samples >= kFeatures)
        known.noise = std::max(kLeastNoise, known.noise + (square - known.noise) * kNoiseRate);
    ++known.samples;
    known.seen = true;
}

/// Whether it is known what this light takes by its method: four timings that count in full, as kPersistentTimings.
bool CostModel::isSettled(const Residual& own, const Features& f) noexcept
{
    return effectiveSamples(own, f) >= kPersistentTimings;
}

/// In octaves of surprise, by the time predicted: what takes none says nothing about the frame's. Settled lights stand
/// in front.
void CostModel::noteVote(Device& device, const Weighted& vote, uint32_t method, bool settled) noexcept
{
    if (device.voteCount == device.votes.size()) return;
    device.mixed = device.voteCount > 0 && (device.mixed || method != device.method);
    device.method = method;
    device.votes[device.voteCount++] = vote;
    if (settled) std::swap(device.votes[device.settled++], device.votes[device.voteCount - 1]);
}

/// What timings say of the device: those of lights whose time was known, as long as there are any. Where nobody knew
/// it, the scene or the method is as likely to be the cause, unless several methods say the same, or nothing is known
/// of the device yet.
uint32_t CostModel::votesThatCount(const Device& device) noexcept
{
    if (device.frames < kDeviceFrames || (device.settled == 0 && device.mixed)) return device.voteCount;
    return device.settled;
}

/// The median of the last five frames' medians is beyond kDeviceStep only if three of them are.
void CostModel::noteStep(Device& device, double frameMedian) noexcept
{
    if (device.frames < kDeviceFrames) { // the mean of the medians so far
        ++device.frames;
        const double change = frameMedian / device.frames;
        device.octaves += device.frames == 1 ? frameMedian : change;
        device.variance = kStartNoise / device.frames;
        return;
    }
    device.steps[device.stepNext] = frameMedian;
    device.stepNext = (device.stepNext + 1) % static_cast<uint32_t>(device.steps.size());
    std::array<double, 5> sorted = device.steps; // empty places are 0
    std::nth_element(sorted.begin(), sorted.begin() + 2, sorted.end());
    if (std::fabs(sorted[2]) <= kDeviceStep) return;
    device.octaves += sorted[2];
    device.steps.fill(0.0);
    device.stepNext = 0;
    // What the lights learned in those frames was the step, not theirs.
    for (size_t i = 0; i < residuals_.size(); ++i)
        if (&deviceOf(static_cast<uint32_t>(i % kTracks)) == &device)
            residuals_[i].recentCount = residuals_[i].recentNext = 0;
}

void CostModel::endFrame() noexcept
{
    for (uint32_t i = 0; i < tracks_.size(); ++i)
        if (std::exchange(tracks_[i].timed, false)) noteScene(i / kTracks, i % kTracks);
    for (Device& device : devices_) {
        if (const uint32_t votes = votesThatCount(device); votes > 0)
            noteStep(device, weightedMedian(std::span(device.votes).first(votes)));
        device.voteCount = device.settled = 0;
    }
}

void CostModel::forgetLight(uint32_t light) noexcept
{
    if (light >= lights_) return;
    const size_t first = size_t{light} * methods_ * kTracks;
    std::fill_n(residuals_.begin() + static_cast<std::ptrdiff_t>(first), size_t{methods_} * kTracks, Residual{});
}

Prediction CostModel::sumOf(const Prediction& gpu, const Prediction& cpu) noexcept
{
    Prediction sum{.ms = gpu.ms + cpu.ms,
                   .sigmaMs = std::sqrt(gpu.sigmaMs * gpu.sigmaMs + cpu.sigmaMs * cpu.sigmaMs),
                   .calibrated = gpu.calibrated || cpu.calibrated};
    sum.sigmaOctaves = sum.ms > 0.0 ? sum.sigmaMs / sum.ms / 0.6931471805599453 : 0.0;
    return sum;
}

const Features& CostModel::recall(const Workload& workload, Pass pass) const noexcept
{
    Recall& known = recalled_[static_cast<size_t>(pass)];
    for (const Recalled& one : known.newest)
        if (one.valid && one.workload == workload) return one.features;
    Recalled& oldest = known.newest[known.next++ % known.newest.size()];
    oldest = {workload, featuresOf(workload, pass), true};
    return oldest.features;
}

Prediction CostModel::predict(uint32_t light, uint32_t method, Pass pass, const Workload& workload) const noexcept
{
    if (method >= methods_) return {};
    const Features& f = recall(workload, pass);
    std::array<Prediction, 2> parts;
    bool any = false;
    for (const Processor processor : {Processor::gpu, Processor::cpu}) {
        if (!track(method, trackOf(pass, processor)).seen) continue;
        const Octaves known = octaves(light, method, trackOf(pass, processor), f);
        any = true;
        Prediction& part = parts[static_cast<size_t>(processor)];
        part.ms = exp2Exactly(known.mean);
        part.sigmaOctaves = std::sqrt(known.variance);
        part.sigmaMs = part.ms * 0.6931471805599453 * part.sigmaOctaves; // d 2^x = ln 2 2^x dx
        part.calibrated = known.calibrated;
    }
    if (any) return sumOf(parts[0], parts[1]);
    // Nobody knows anything: the prior of the GPU, with its doubt. A method known by its other pass has no such pass.
    const Pass other = pass == Pass::update ? Pass::resolve : Pass::update;
    for (const Processor processor : {Processor::gpu, Processor::cpu})
        if (track(method, trackOf(other, processor)).seen) return {};
    const Octaves guess = octaves(light, method, trackOf(pass, Processor::gpu), f);
    Prediction prediction{.ms = exp2Exactly(guess.mean), .sigmaOctaves = std::sqrt(guess.variance)};
    prediction.sigmaMs = prediction.ms * 0.6931471805599453 * prediction.sigmaOctaves;
    return prediction;
}

Prediction CostModel::predict(uint32_t light, uint32_t method, const Workload& workload,
                              bool updateSkipped) const noexcept
{
    const Prediction resolve = predict(light, method, Pass::resolve, workload);
    if (updateSkipped) return resolve;
    const Prediction update = predict(light, method, Pass::update, workload);
    Prediction sum{.ms = update.ms + resolve.ms,
                   .sigmaMs = std::sqrt(update.sigmaMs * update.sigmaMs + resolve.sigmaMs * resolve.sigmaMs),
                   .calibrated = (update.calibrated || update.ms == 0.0) && (resolve.calibrated || resolve.ms == 0.0) &&
                                 (update.calibrated || resolve.calibrated)};
    sum.sigmaOctaves = sum.ms > 0.0 ? sum.sigmaMs / sum.ms / 0.6931471805599453 : 0.0;
    return sum;
}

} // namespace gnomon::cost
