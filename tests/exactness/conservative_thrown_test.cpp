// conservative_map and conservative_map_adjacency show what ray_traced shows, wherever camera, lights and casters are.
#include "exactness/thrown.hpp"

namespace gnomon::exact {
namespace {

constexpr const char* kMethods[] = {"conservative_map", "conservative_map_adjacency"};
constexpr VkExtent2D kSize{160, 90};
// Drawn for each frame; 1024, the default, for every tenth. The test's time goes with texels, triangles and lights; so
// one light at a time, in turn.
constexpr double kSides[] = {128.0, 256.0, 512.0};

struct Frame {
    Throw thrown;
    double texels = 0.0;
    Pictures truth;
    std::uint64_t rays = 0; ///< Of ray_traced.
};

Frame frameOf(Thrown& thrown, Dice& dice, std::size_t lights)
{
    Frame frame{.thrown = thrown.next(dice, lights), .truth = {}};
    frame.truth = thrown.draw("ray_traced", frame.thrown);
    frame.rays = thrown.rays();
    return frame;
}

struct Drawn {
    Apart apart;
    std::uint64_t traced = 0, all = 0;
    std::size_t copies = 0; ///< Of layers with what stands still.
};

Drawn drawFrames(Thrown& thrown, const std::string& method, const std::vector<Frame>& frames)
{
    Drawn drawn;
    for (std::size_t number = 0; number < frames.size(); ++number) {
        CAPTURE(number);
        const Frame& frame = frames[number];
        demo::expect(thrown.session().shadows.set(method, "resolution", frame.texels));
        const Pictures shown = thrown.draw(method.c_str(), frame.thrown);
        drawn.traced += thrown.rays();
        drawn.all += frame.rays;
        drawn.copies += thrown.passes("copy_statics");
        compareWith(thrown, frame.thrown, frame.truth, shown, drawn.apart);
    }
    return drawn;
}

Drawn checkFrames(Thrown& thrown, const std::string& method, const std::vector<Frame>& frames)
{
    CAPTURE(thrown.scene().name);
    CAPTURE(method);
    const Drawn drawn = drawFrames(thrown, method, frames);
    MESSAGE(thrown.scene().name << ", " << method << ": " << inWords(drawn.apart) << "; traced " << drawn.traced
                                << " of " << drawn.all);
    CHECK(drawn.apart.clear == 0);
    CHECK(drawn.apart.pixels <= 2); // ambiguous ones, of at most 576 000
    CHECK(drawn.apart.dark > 1000);
    CHECK(drawn.traced < drawn.all);
    return drawn;
}

} // namespace

TEST_CASE("conservative maps equal ray_traced from 20 cameras under 20 throws of the lights of every shipped scene")
{
    const test::DeviceTest silence;
    unsigned seed = 101;
    for (const std::string& name : sceneNames()) {
        Thrown thrown(shippedScene(name), kSize);
        Dice dice(seed++);
        std::vector<Frame> frames;
        for (int number = 0; number < 20; ++number) {
            frames.push_back(frameOf(thrown, dice, 1));
            const auto side = static_cast<std::size_t>(dice.between(0.0, 2.999));
            frames.back().texels = number % 10 == 9 ? 1024.0 : kSides[side];
        }
        for (const char* method : kMethods)
            checkFrames(thrown, method, frames);
    }
}

// Of those scenes whose static triangles are worth keeping apart. Their lights stand still, but for two that move.
TEST_CASE("it is so of layers kept from frame to frame, with what moves drawn over what stands still")
{
    const test::DeviceTest silence;
    unsigned seed = 201;
    for (const char* name : {"bunny", "colonnade", "rooms"}) {
        Thrown thrown(shippedScene(name), kSize, Lights::asTheyAre);
        Dice dice(seed++);
        std::vector<Frame> frames;
        for (int number = 0; number < 5; ++number) {
            frames.push_back(frameOf(thrown, dice, thrown.scene().lights.size()));
            frames.back().texels = 512.0;
        }
        for (const char* method : kMethods)
            CHECK(checkFrames(thrown, method, frames).copies > 4);
    }
}

} // namespace gnomon::exact
