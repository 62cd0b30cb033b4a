#include "runtime/passes/pass_graph.hpp"

#include <algorithm>
#include <cstring>

#include "runtime/base/hash.hpp"

namespace gnomon {

namespace {

constexpr VkPipelineStageFlags2 kShaderStages =
    VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT | VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT;
constexpr VkPipelineStageFlags2 kFragmentTests =
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT;

bool isCpu(PassKind kind)
{
    return kind == PassKind::prepare || kind == PassKind::host;
}

bool overlap(const Rect& a, const Rect& b)
{
    if (a.width == 0 || b.width == 0) return true; // the whole layer
    auto apart = [](std::int64_t a0, std::int64_t aSize, std::int64_t b0, std::int64_t bSize) {
        return a0 + aSize <= b0 || b0 + bSize <= a0;
    };
    return !apart(a.x, a.width, b.x, b.width) && !apart(a.y, a.height, b.y, b.height);
}

bool conflict(const Access& older, const Access& newer, PassKind olderKind, PassKind newerKind)
{
    const AccessTraits a = accessTraits(older, olderKind), b = accessTraits(newer, newerKind);
    if (!older.isImage) return a.write || b.write;
    const bool layersApart = older.part.layer + older.part.layerCount <= newer.part.layer ||
                             newer.part.layer + newer.part.layerCount <= older.part.layer;
    if (layersApart) return false;
    if (a.layout != b.layout) return true; // a layout belongs to the whole layer
    return (a.write || b.write) && overlap(older.part.rect, newer.part.rect);
}

} // namespace

AccessTraits accessTraits(AccessKind kind, PassKind pass)
{
    const VkPipelineStageFlags2 shader =
        pass == PassKind::compute ? VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT : kShaderStages;
    switch (kind) {
    case AccessKind::sampled:
        return {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, shader, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT, false};
    case AccessKind::storageRead:
        return {VK_IMAGE_LAYOUT_GENERAL, shader, VK_ACCESS_2_SHADER_STORAGE_READ_BIT, false};
    case AccessKind::storageWrite:
        return {VK_IMAGE_LAYOUT_GENERAL, shader, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, true};
    case AccessKind::storageUpdate:
        return {VK_IMAGE_LAYOUT_GENERAL, shader,
                VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT, true};
    case AccessKind::color:
    case AccessKind::colorBlend:
        return {VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT, true};
    case AccessKind::depthTest:
    case AccessKind::stencilTest:
        return {VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, kFragmentTests,
                VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT, false};
    case AccessKind::depthWrite:
    case AccessKind::stencilWrite:
        return {VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, kFragmentTests,
                VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT, true};
    case AccessKind::copySource:
        return {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                VK_ACCESS_2_TRANSFER_READ_BIT, false};
    case AccessKind::copyTarget:
        return {VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                VK_ACCESS_2_TRANSFER_WRITE_BIT, true};
    case AccessKind::vertex:
        return {VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_VERTEX_ATTRIBUTE_INPUT_BIT,
                VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT, false};
    case AccessKind::index:
        return {VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_INDEX_INPUT_BIT, VK_ACCESS_2_INDEX_READ_BIT, false};
    case AccessKind::indirect:
        return {VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT,
                false};
    case AccessKind::hostRead:
        return {VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT, false};
    case AccessKind::hostWrite:
        return {VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_WRITE_BIT, true};
    case AccessKind::build:
        return {VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
                VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR | VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR,
                true};
    case AccessKind::buildInput:
        return {VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
                VK_ACCESS_2_SHADER_READ_BIT, false};
    case AccessKind::trace:
        return {VK_IMAGE_LAYOUT_UNDEFINED, shader, VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR, false};
    }
    return {};
}

AccessTraits accessTraits(const Access& access, PassKind pass)
{
    AccessTraits traits = accessTraits(access.kind, pass);
    const bool tested = access.kind == AccessKind::depthTest || access.kind == AccessKind::stencilTest;
    traits.write |= tested && access.part.clear;
    return traits;
}

// --- keys ---

std::uint64_t PassGraph::key(Scope scope, const char* name, std::uint32_t variant, std::uint64_t salt) const
{
    const std::uint64_t hash = hashOfBytes(name, mixed(salt, variant));
    if (scope == Scope::scene) return mixed(hash, 4); // of no task: there need not be one
    const std::uint64_t view = view_ ? view_->id : UINT32_MAX;
    switch (scope) {
    case Scope::view:
        return mixed(mixed(hash, 1), view);
    case Scope::light:
        return mixed(mixed(hash, 2), owner_.light);
    case Scope::scene:
    case Scope::task:
        break;
    }
    return mixed(mixed(mixed(mixed(hash, 3), view), owner_.light), owner_.method);
}

std::uint32_t PassGraph::find(std::uint64_t key) const
{
    const std::size_t mask = table_.size() - 1;
    for (std::size_t i = key & mask; table_[i].epoch == epoch_; i = (i + 1) & mask)
        if (table_[i].key == key) return table_[i].index;
    return UINT32_MAX;
}

void PassGraph::store(std::uint64_t key, std::uint32_t index)
{
    if (++tableUsed_ * 2 > table_.size()) {
        std::vector<Slot> old(table_.size() * 2);
        old.swap(table_);
        const std::size_t mask = table_.size() - 1;
        for (const Slot& slot : old) {
            if (slot.epoch != epoch_) continue;
            std::size_t i = slot.key & mask;
            while (table_[i].epoch == epoch_)
                i = (i + 1) & mask;
            table_[i] = slot;
        }
    }
    const std::size_t mask = table_.size() - 1;
    std::size_t i = key & mask;
    while (table_[i].epoch == epoch_ && table_[i].key != key)
        i = (i + 1) & mask;
    table_[i] = {key, index, epoch_};
}

void PassGraph::reset()
{
    passes_.clear();
    accesses_.clear();
    images_.clear();
    buffers_.clear();
    order_.clear();
    tasks_.clear();
    ++epoch_;
    tableUsed_ = 0;
    rounds_ = 1;
    firstRound_ = 0;
    counts_ = {};
    error_.reset();
}

// --- tasks ---

void PassGraph::beginTask(const PassOwner& owner, const CameraView* view, ImageId depth, ImageId normals)
{
    tasks_.push_back({owner, view, depth, normals});
    resumeTask(static_cast<std::uint32_t>(tasks_.size() - 1));
}

void PassGraph::resumeTask(std::uint32_t task)
{
    task_ = task;
    owner_ = tasks_[task].owner;
    view_ = tasks_[task].view;
    depth_ = tasks_[task].depth;
    normals_ = tasks_[task].normals;
    taskFirstPass_ = passes_.size();
    taskCounts_ = {};
    taskStale_.clear();
    error_.reset();
}

std::optional<Error> PassGraph::endTask()
{
    if (!error_) {
        counts_ += taskCounts_;
        return std::nullopt;
    }
    // The task cannot run. Its passes become empty ones, since they are known by their place, and what they would have
    // made is not kept. View-scope passes that are whole stay: other lights share them. Of the others, a later task of
    // the frame declares those again that it shares.
    for (std::size_t i = taskFirstPass_; i < passes_.size(); ++i) {
        Pass& pass = passes_[i];
        if (pass.owner.light == UINT32_MAX && pass.fn) continue;
        pass.fn = nullptr;
        for (const Access& access : accesses(pass)) {
            if (!accessTraits(access, pass.kind).write) continue;
            (access.isImage ? images_[access.resource].pooled->kept : buffers_[access.resource].pooled->kept).lose();
        }
    }
    for (KeptState* promised : taskStale_) // stamps that lie beside what they are of
        promised->lose();
    std::optional<Error> error = std::move(error_);
    error_.reset();
    return error;
}

void PassGraph::fail(const Error& error)
{
    if (!error_) error_ = error;
}

ImageId PassGraph::addImage(PooledImage& image, const char* name)
{
    // Two views may share their depth: accesses are ordered among those of one id.
    for (std::uint32_t i = 0; i < images_.size(); ++i)
        if (images_[i].pooled == &image) return {i};
    images_.push_back({.key = 0, .pooled = &image, .name = name, .newest = UINT32_MAX});
    return {static_cast<std::uint32_t>(images_.size() - 1)};
}

BufferId PassGraph::addBuffer(PooledBuffer& buffer)
{
    pool_.touch(buffer);
    buffers_.push_back(
        {.key = 0, .pooled = &buffer, .ring = nullptr, .info = {.size = buffer.gpu.size}, .newest = UINT32_MAX});
    return {static_cast<std::uint32_t>(buffers_.size() - 1)};
}

// --- passes ---

PassRef PassGraph::open(PassKind kind, const char* name, Scope scope, std::uint32_t variant)
{
    pendingKey_ = key(scope, name, variant, 0x70617373); // "pass"
    const std::uint32_t known = find(pendingKey_);
    pendingDropped_ = known != UINT32_MAX && passes_[known].fn; // one that was taken back is declared again
    pendingBroken_ = false;
    pending_ = Pass{.name = name, .kind = kind, .owner = owner_};
    pending_.owner.declarer = owner_.method;
    const MethodSet own = owner_.method < kMaxMethods ? MethodSet{owner_.method} : MethodSet{};
    pending_.owner.declarers = own;
    if (pendingDropped_) passes_[known].owner.declarers |= own;
    if (scope != Scope::task) pending_.owner.method = UINT32_MAX;
    if (scope == Scope::view || scope == Scope::scene) pending_.owner.light = UINT32_MAX;
    if (scope == Scope::light || scope == Scope::scene) pending_.owner.view = UINT32_MAX;
    pending_.firstAccess = static_cast<std::uint32_t>(accesses_.size());
    pending_.task = task_;
    pending_.round = firstRound_;
    return PassRef(*this);
}

void PassGraph::add(std::uint32_t resource, bool isImage, AccessKind kind, const Part& part)
{
    if (pendingDropped_) return;
    if (resource == UINT32_MAX) { // optional (no normals), or it could not be made
        pendingBroken_ |= error_.has_value();
        return;
    }
    Access access{.resource = resource, .isImage = isImage, .kind = kind, .part = part};
    if (isImage) {
        const std::uint32_t layers = static_cast<std::uint32_t>(images_[resource].pooled->layers.size());
        if (part.layerCount == VK_REMAINING_ARRAY_LAYERS) access.part.layerCount = layers - part.layer;
    }
    access.pass = static_cast<std::uint32_t>(passes_.size());
    accesses_.push_back(access);
}

/// A map that follows the view is kept by the task, and what draws it costs what the drawing of any map does.
bool PassGraph::drawsKept(const Pass& pass) const
{
    bool writes = false;
    for (const Access& access : accesses(pass)) {
        if (!accessTraits(access, pass.kind).write) continue;
        if (!access.isImage || !images_[access.resource].keptDepths) return false;
        writes = true;
    }
    return writes;
}

void PassGraph::close(void (*fn)(void*, PassContext*, HostContext*), const void* body, std::size_t size,
                      std::size_t alignment)
{
    if (pendingDropped_) return;
    pending_.accessCount = static_cast<std::uint32_t>(accesses_.size()) - pending_.firstAccess;
    pending_.fn = pendingBroken_ ? nullptr : fn;
    pending_.owner.drawsKept = drawsKept(pending_);
    pending_.body = arena_.allocate(size, alignment);
    std::memcpy(pending_.body, body, size);
    const std::uint32_t index = static_cast<std::uint32_t>(passes_.size());
    place(pending_, index);
    passes_.push_back(pending_);
    store(pendingKey_, index);
}

/// Round and batch follow from the newest conflicting accesses before it.
void PassGraph::place(Pass& pass, std::uint32_t index)
{
    const bool cpu = isCpu(pass.kind);
    auto after = [&](const Pass& older) {
        const bool olderCpu = isCpu(older.kind);
        if (older.kind == PassKind::prepare && pass.kind != PassKind::prepare && !cpu) return; // ran before recording
        const std::uint32_t round = older.kind == PassKind::host && !cpu ? older.round + 1 : older.round;
        if (round > pass.round) {
            pass.round = round;
            pass.batch = 0;
        }
        if (olderCpu == cpu && older.round == pass.round) pass.batch = std::max(pass.batch, older.batch + 1);
    };
    for (std::uint32_t i = pass.firstAccess; i < pass.firstAccess + pass.accessCount; ++i) {
        Access& access = accesses_[i];
        std::uint32_t& newest = access.isImage ? images_[access.resource].newest : buffers_[access.resource].newest;
        for (std::uint32_t older = newest; older != UINT32_MAX; older = accesses_[older].next) {
            if (accesses_[older].pass == index) continue;
            const Pass& olderPass = passes_[accesses_[older].pass];
            if (!olderPass.fn) continue; // taken back: does nothing
            if (conflict(accesses_[older], access, olderPass.kind, pass.kind)) after(olderPass);
        }
        access.next = newest;
        newest = i;
    }
    rounds_ = std::max(rounds_, pass.round + 1);
}

std::span<const std::uint32_t> PassGraph::order()
{
    order_.resize(passes_.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i)
        order_[i] = i;
    auto side = [](PassKind kind) { return kind == PassKind::prepare ? 0 : kind == PassKind::host ? 2 : 1; };
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
        const Pass &x = passes_[a], &y = passes_[b];
        if (x.round != y.round) return x.round < y.round;
        if (side(x.kind) != side(y.kind)) return side(x.kind) < side(y.kind);
        if (x.batch != y.batch) return x.batch < y.batch;
        return a < b;
    });
    return order_;
}

} // namespace gnomon
