// ray_soft from frame to frame: what its history survives, when it is held back, and what it takes of memory.
#include "algorithms/entries.hpp"
#include "device/memory_books.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/packing.hpp>

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr size_t kBall = 1;
constexpr const char* kSoft = "ray_soft";

Scene wideLight()
{
    Scene scene = smallScene();
    scene.lights[0].radius = 0.4f;
    scene.instances[kBall].isStatic = false;
    return scene;
}

/// Tests of the method end here on devices without.
bool canTrace()
{
    return tracesRays(Host(smallScene(), {.warmUp = false}).context);
}

std::vector<Image8> drawn(Host& host, uint32_t frames, const FrameOptions& options = {})
{
    host.pinAll(kSoft);
    host.draw(frames, options);
    REQUIRE(host.decision(0).reason == GN_REASON_PINNED);
    return host.pictures();
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest,
                  "a dropped frame leaves the history as it was, and recorded frames show what submitted do")
{
    if (!canTrace()) return;
    const FrameOptions record{.call = Call::record};
    Host dropping(wideLight()), plain(wideLight());
    const std::vector<Image8> third = drawn(plain, 3);
    dropping.pinAll(kSoft);
    dropping.require(dropping.draw({.call = Call::record, .drop = true})); // the first of all
    drawn(dropping, 2, record);
    dropping.require(dropping.draw({.call = Call::record, .drop = true}));
    CHECK(differences(drawn(dropping, 1, record), third) == 0);
    for (Host* host : {&dropping, &plain})
        host->scene.instances[kBall].pose.position.x += 0.2;
    dropping.require(dropping.draw({.call = Call::record, .drop = true}));
    const std::vector<Image8> moved = drawn(plain, 1);
    CHECK(differences(drawn(dropping, 1, record), moved) == 0);
    CHECK(differences(moved, third) > 50);
}

TEST_CASE_FIXTURE(DeviceTest, "the past is held back where something moves, and only there it costs a pass")
{
    if (!canTrace()) return;
    Host host(wideLight());
    drawn(host, 2);
    CHECK(host.passCount("ray_soft.accumulate") == 1);
    CHECK(host.passCount("ray_soft.blur_now") == 0);
    host.scene.instances[kBall].pose.position.x += 0.2;
    drawn(host, 1);
    CHECK(host.passCount("ray_soft.blur_now") == 1);
    drawn(host, 1);
    CHECK(host.passCount("ray_soft.blur_now") == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "a view of another size, or after a cut, begins again")
{
    if (!canTrace()) return;
    Host host(wideLight()), fresh(wideLight());
    const std::vector<Image8> first = drawn(fresh, 1);
    drawn(host, 3);
    const FrameOptions cut{.adjust = [](GnFrameInfo&, std::vector<GnViewFrame>& views) { views[0].cameraCut = 1; }};
    CHECK(differences(drawn(host, 1, cut), first) == 0);
    CHECK(differences(drawn(host, 1), first) > 50); // which is no first frame
    host.resize({200, 120});
    fresh.resize({200, 120});
    CHECK(differences(drawn(host, 1), drawn(fresh, 1)) == 0);
}

TEST_CASE_FIXTURE(DeviceTest, "memory is what the plan is told")
{
    if (!canTrace()) return;
    MemoryBooks books;
    Host host(wideLight(), books.options({.extent = {256, 128}})); // whole tiles of every device
    drawn(host, 3);
    const VkDeviceSize held = books.held("ray_soft.").bytes;
    if (held == 0) return; // without validation nothing has a name
    CAPTURE(books.list());
    const VkDeviceSize told = kRaySoft.memoryFor(std::vector<double>{1.0, 256.0}, host.extent(), GN_LIGHT_TYPE_SPOT);
    CHECK(held <= told);
    CHECK(held >= told - told / 50);
}

namespace {

/// What a host's motion vectors say of it.
enum class Says { nothing, screen, depthToo, noNumber };

/// How the host draws.
struct Habits {
    VkFormat motion = VK_FORMAT_R32G32B32A32_SFLOAT; ///< Or R16G16_SFLOAT.
    bool jitters = false;                            ///< By up to half a pixel, each frame otherwise.
    uint32_t dropped = 0;                            ///< This frame, of which the first is 1; 0: none.
};

/// A floor that fills what the camera sees, under casters that it does not see. Floor and casters move by so much a
/// frame, and the host draws vectors of the floor: how far it has come since, as a share of the image.
class Platform {
public:
    Platform(Says says, const glm::dvec3& floorStep, const glm::dvec3& casterStep, const Habits& habits = {})
        : host(floorAndSun(), {.extent = {320, 180}}), says_(says), floorStep_(floorStep), casterStep_(casterStep),
          habits_(habits),
          image_(makeImage(device(), {.format = habits.motion,
                                      .extent = host.extent(),
                                      .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT})),
          texels_(makeBuffer(device(), VkDeviceSize{sizeof(glm::vec4)} * 320 * 180, VK_BUFFER_USAGE_TRANSFER_SRC_BIT))
    {
        for (const size_t caster : {1, 2})
            host.hide(caster);
        host.pinAll(kSoft);
    }

    /// What is shown; nothing if the frame is dropped.
    Image8 next()
    {
        host.scene.instances[0].pose.position += floorStep_;
        for (const size_t caster : {1, 2})
            host.scene.instances[caster].pose.position += casterStep_;
        ++frame_;
        writeVectors();
        const bool drop = frame_ == habits_.dropped;
        host.require(host.draw({.call = Call::record,
                                .drop = drop,
                                .lens = [this](auto& camera) { shake(camera, frame_); },
                                .adjust = [this](auto&, auto& views) { give(views[0]); },
                                .around =
                                    [this](VkCommandBuffer cmd, bool begins) {
                                        if (begins) upload(cmd);
                                    }}));
        if (drop) return Image8(1, 1, 0);
        REQUIRE(host.decision(0).reason == GN_REASON_PINNED);
        return host.pictures()[0];
    }
    /// RMSE over the penumbra, against many rays.
    double error(const Image8& picture) const
    {
        Host many(host.scene, {.extent = host.extent()});
        for (const size_t caster : {1, 2})
            many.hide(caster);
        many.require(gnSetMethodSetting(many.context, "ray_traced", "samples", 256.0));
        many.pinAll("ray_traced");
        many.require(many.draw({.lens = [this](auto& camera) { shake(camera, frame_); }}));
        const Image8 truth = many.pictures()[0];
        double sum = 0.0;
        size_t count = 0;
        for (size_t i = 0; i < truth.texels.size(); ++i) {
            if (truth.texels[i] == 0 || truth.texels[i] == 255) continue;
            const double off = (picture.texels[i] - truth.texels[i]) / 255.0;
            sum += off * off;
            ++count;
        }
        CHECK(count > 300);
        return std::sqrt(sum / double(count));
    }

    Host host;

private:
    static Scene floorAndSun()
    {
        Scene scene = smallScene();
        demo::Light& sun = scene.lights[0];
        sun.kind = demo::LightKind::Directional;
        sun.range = sun.innerAngle = sun.outerAngle = 0.0f;
        sun.radius = 0.25f;
        for (demo::Instance& instance : scene.instances)
            instance.isStatic = false;
        return scene;
    }

    /// By how many pixels the frame's picture is moved to the left and up.
    glm::dvec2 shakeOf(uint32_t frame) const
    {
        static constexpr double kShakes[][2] = {
            {0.0, -0.17}, {-0.25, 0.17}, {0.25, -0.39}, {-0.375, -0.06}, {0.125, 0.28}};
        return habits_.jitters ? glm::dvec2(kShakes[frame % 5][0], kShakes[frame % 5][1]) : glm::dvec2(0.0);
    }
    void shake(demo::CameraMatrices& camera, uint32_t frame) const
    {
        const glm::dvec2 clip = 2.0 * shakeOf(frame) / glm::dvec2(host.extent().width, host.extent().height);
        camera.projection[2][0] += static_cast<float>(clip.x);
        camera.projection[2][1] += static_cast<float>(clip.y);
        camera.clipFromEye = camera.projection * glm::mat4(camera.viewFromWorld);
    }

    void writeVectors()
    {
        const demo::CameraMatrices camera = cameraMatrices(host.scene, cameraAt(host.scene, 0.0), host.extent());
        demo::CameraMatrices before = camera;
        shake(before, frame_ - 1);
        const VkExtent2D extent = host.extent();
        const glm::dvec2 size(extent.width, extent.height);
        const double height = host.scene.instances[0].pose.position.y + 0.1 - camera.eye.y; // of the floor's top
        for (uint32_t y = 0; y < extent.height; ++y)
            for (uint32_t x = 0; x < extent.width; ++x) {
                const glm::dvec2 at(x + 0.5, y + 0.5), plain = at + shakeOf(frame_);
                const glm::dvec3 ray(camera.rayCorner + float(plain.x) * camera.rayDx + float(plain.y) * camera.rayDy);
                const double depth = height / ray.y;
                const glm::dvec4 was = glm::dmat4(before.clipFromEye) * glm::dvec4(depth * ray - floorStep_, 1.0);
                const glm::vec2 came((at - (glm::dvec2(was) / was.w * 0.5 + 0.5) * size) / size);
                const uint32_t pixel = y * extent.width + x;
                if (habits_.motion == VK_FORMAT_R16G16_SFLOAT)
                    texels_.as<uint32_t>()[pixel] = glm::packHalf2x16(came);
                else
                    texels_.as<glm::vec4>()[pixel] = says_ == Says::noNumber
                                                         ? glm::vec4(std::nanf(""))
                                                         : glm::vec4(came, float(was.w - depth), std::nanf(""));
            }
    }

    void upload(VkCommandBuffer cmd)
    {
        using namespace demo;
        constexpr Access before{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT}, // gnomon's reads of the frame before
            copied{VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL},
            read{VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_MEMORY_READ_BIT,
                 VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
        cmdBarrier(cmd, std::array{imageBarrier(image_.get(), VK_IMAGE_ASPECT_COLOR_BIT, before, copied)});
        const VkBufferImageCopy all{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                    .imageExtent = {image_.extent.width, image_.extent.height, 1}};
        vkCmdCopyBufferToImage(cmd, texels_.get(), image_.get(), copied.layout, 1, &all);
        cmdBarrier(cmd, std::array{imageBarrier(image_.get(), VK_IMAGE_ASPECT_COLOR_BIT, copied, read)});
    }

    void give(GnViewFrame& view) const
    {
        if (says_ == Says::nothing) return;
        view.motionImage = image_.get();
        view.motionView = image_.view.get();
        view.motionFormat = image_.format;
        view.motionScale[0] = -static_cast<float>(view.imageExtent.width); // from now back, in pixels
        view.motionScale[1] = -static_cast<float>(view.imageExtent.height);
        view.motionScale[2] = says_ == Says::depthToo ? 1.0f : 0.0f;
    }

    Says says_;
    glm::dvec3 floorStep_, casterStep_;
    Habits habits_;
    uint32_t frame_ = 0;
    demo::Image image_;
    demo::Buffer texels_;
};

/// After some frames.
double errorOf(Says says, const glm::dvec3& floorStep, const glm::dvec3& casterStep, const Habits& habits = {},
               int frames = 10)
{
    Platform platform(says, floorStep, casterStep, habits);
    Image8 picture;
    for (int frame = 0; frame < frames; ++frame)
        picture = platform.next();
    return platform.error(picture);
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "motion vectors keep what is known of receivers that move with their shadows")
{
    if (!canTrace()) return;
    struct Move {
        const char* name;
        glm::dvec3 step;
    };
    for (const Move& move : {Move{"up", {0.0, 0.25, 0.0}}, Move{"across", {0.25, 0.0, 0.0}}}) {
        CAPTURE(std::string(move.name));
        const glm::dvec3& step = move.step;
        const double without = errorOf(Says::nothing, step, step), screen = errorOf(Says::screen, step, step),
                     depthToo = errorOf(Says::depthToo, step, step);
        MESSAGE(std::string(move.name) << ": RMSE in the penumbra " << without << " without vectors, " << screen
                                       << " with, " << depthToo << " with depth");
        CHECK(screen <= 0.95 * without);
        CHECK(depthToo <= 0.95 * without);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "motion vectors of what moves under a shadow that stays leave no ghosts")
{
    if (!canTrace()) return;
    const glm::dvec3 step(0.25, 0.0, 0.0), still(0.0);
    const double without = errorOf(Says::nothing, step, still), with = errorOf(Says::depthToo, step, still);
    MESSAGE("RMSE in the penumbra " << without << " without vectors, " << with << " with");
    CHECK(with <= 1.35 * without);
}

TEST_CASE_FIXTURE(DeviceTest, "motion vectors change nothing at rest, or where they are no numbers")
{
    if (!canTrace()) return;
    for (const auto& [says, step] :
         {std::pair(Says::depthToo, glm::dvec3(0.0)), std::pair(Says::noNumber, glm::dvec3(0.1, 0.0, 0.0))}) {
        Platform plain(Says::nothing, step, step), given(says, step, step);
        for (int frame = 0; frame < 4; ++frame)
            CHECK(differences(given.next(), plain.next()) == 0);
    }
}

TEST_CASE_FIXTURE(DeviceTest, "motion vectors of 16 bits serve as those of 32 do")
{
    if (!canTrace()) return;
    const glm::dvec3 step(0.0, 0.25, 0.0);
    const double without = errorOf(Says::nothing, step, step), wide = errorOf(Says::screen, step, step),
                 half = errorOf(Says::screen, step, step, {.motion = VK_FORMAT_R16G16_SFLOAT});
    MESSAGE("RMSE in the penumbra " << without << " without vectors, " << wide << " with, " << half << " of 16 bits");
    CHECK(half <= 0.95 * without);
    CHECK(std::abs(half - wide) <= 0.02 * wide); // halves of such vectors are a hundredth of a pixel apart
}

TEST_CASE_FIXTURE(DeviceTest, "a camera that shakes keeps its history, with vectors and without")
{
    if (!canTrace()) return;
    const glm::dvec3 still(0.0);
    const Habits shaken{.jitters = true};
    const double first = errorOf(Says::nothing, still, still, {}, 1), steady = errorOf(Says::nothing, still, still),
                 without = errorOf(Says::nothing, still, still, shaken),
                 with = errorOf(Says::screen, still, still, shaken);
    MESSAGE("RMSE in the penumbra " << first << " of one frame, " << steady << " of a camera at rest, " << without
                                    << " of one that shakes, " << with << " with vectors");
    CHECK(steady <= 0.8 * first);
    CHECK(without <= 1.25 * steady); // what was seen lies between pixels, and is interpolated
    CHECK(with <= 1.25 * steady);
}

TEST_CASE_FIXTURE(DeviceTest, "motion vectors to a frame that was dropped do not count, and later ones do")
{
    if (!canTrace()) return;
    const glm::dvec3 step(0.0, 0.25, 0.0);
    const Habits last{.dropped = 9}, earlier{.dropped = 3};
    const double atOnce = errorOf(Says::screen, step, step, last), none = errorOf(Says::nothing, step, step, last),
                 later = errorOf(Says::screen, step, step, earlier),
                 without = errorOf(Says::nothing, step, step, earlier);
    MESSAGE("RMSE in the penumbra a frame after a dropped one "
            << atOnce << " with vectors, " << none << " without; seven frames after " << later << " and " << without);
    CHECK(atOnce <= 1.01 * none);
    CHECK(later <= 0.95 * without);
}
