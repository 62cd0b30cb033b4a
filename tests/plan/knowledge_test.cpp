#include <cmath>
#include <doctest/doctest.h>
#include <string>

#include "runtime/cost/knowledge_base.hpp"
#include "tests/plan/random.hpp"

using namespace gnomon::cost;
using gnomon::test::Random;

namespace {

DeviceKnowledge anyDevice()
{
    DeviceKnowledge device{"a, \"b\"", "d", "integrated", {}, {}};
    for (const char* name : {"shadow_map", "ray_traced"}) {
        AlgorithmCost cost{
            .algorithm = name, .tracks = {}, .wrongPercent = 0.125, .wrongSamples = 12, .firstFrameMs = 3.5};
        cost.tracks[trackOf(Pass::update, Processor::gpu)] = {
            .ms = {0.5, 46.0, 0.0, 0.25}, .octaves = 0.375, .samples = 80};
        cost.tracks[trackOf(Pass::resolve, Processor::cpu)] = {
            .ms = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 1.25}, .octaves = 0.5, .samples = 90};
        device.algorithms.push_back(cost);
    }
    device.parts.push_back({"stencil_volume", "volumes.strips, all", 2e-6});
    return device;
}

} // namespace

TEST_CASE("a knowledge base reads back as it was written")
{
    const DeviceKnowledge device = anyDevice();
    const std::string text = writeKnowledge({&device, 1});
    const KnowledgeResult read = parseKnowledge(text);
    REQUIRE(read.base);
    REQUIRE(read.base->devices.size() == 1);
    const DeviceKnowledge& back = read.base->devices[0];
    CHECK(writeKnowledge({&back, 1}) == text);
    CHECK(parseKnowledge("\xef\xbb\xbf" + text).base); // as editors mark UTF-8
    CHECK(back.device == device.device);
    CHECK(back.kind == "integrated");
    const AlgorithmCost* rays = back.find("ray_traced");
    REQUIRE(rays);
    const TrackCost& resolve = rays->tracks[trackOf(Pass::resolve, Processor::cpu)];
    CHECK(resolve.ms[static_cast<size_t>(Term::rayLevels)] == 1.25);
    CHECK(resolve.octaves == 0.5);
    CHECK(resolve.samples == 90);
    CHECK(rays->tracks[trackOf(Pass::resolve, Processor::gpu)].samples == 0);
    CHECK(rays->wrongPercent == 0.125);
    CHECK(rays->firstFrameMs == 3.5);
    REQUIRE(back.parts.size() == 1);
    CHECK(back.parts[0].pass == "volumes.strips, all");
    CHECK(back.parts[0].msPerPixel == doctest::Approx(2e-6));
    CHECK_FALSE(back.find("nobody"));
}

TEST_CASE("the nearest device is the same one, else one of its kind, else a GPU for a GPU, else the first")
{
    KnowledgeBase base;
    CHECK_FALSE(base.nearestTo("x", "software"));
    base.devices = {{"s", "", "software", {}, {}}, {"d1", "", "discrete", {}, {}}, {"d2", "", "discrete", {}, {}}};
    CHECK(base.nearestTo("d2", "software")->device == "d2");
    CHECK(base.nearestTo("x", "discrete")->device == "d1");
    CHECK(base.nearestTo("x", "integrated")->device == "d1"); // a GPU, not the processor
    base.devices = {{"s", "", "software", {}, {}}, {"i", "", "integrated", {}, {}}};
    CHECK(base.nearestTo("x", "discrete")->device == "i");
    CHECK(base.nearestTo("x", "other")->device == "s");
    base.devices.erase(base.devices.begin());
    CHECK(base.nearestTo("x", "software")->device == "i"); // there is no other
}

TEST_CASE("the shipped bases are whole, and every fit is worth its name")
{
    const KnowledgeBase& shipped = shippedKnowledge();
    REQUIRE(shipped.devices.size() == 2);
    for (const DeviceKnowledge& device : shipped.devices) {
        CHECK(device.algorithms.size() >= 19);
        CHECK_FALSE(device.parts.empty());
        for (const AlgorithmCost& cost : device.algorithms)
            for (const TrackCost& track : cost.tracks)
                if (track.samples > 0) CHECK_MESSAGE(track.octaves < 2.0, device.device, ' ', cost.algorithm);
    }
    CHECK(shipped.nearestTo("any", "software")->kind == "software");
    CHECK(shipped.nearestTo("any", "discrete")->kind == "discrete");
    CHECK(shipped.nearestTo("any", "integrated")->kind == "discrete");
}

TEST_CASE("a damaged knowledge base is an error that names the first damaged row")
{
    const std::string head = writeKnowledge({});
    CHECK(parseKnowledge(head).base->devices.empty()); // an empty one is fine
    CHECK_FALSE(parseKnowledge("").base);
    CHECK_FALSE(parseKnowledge("# gnomon knowledge 0\n").base);
    CHECK(parseKnowledge("# gnomon knowledge 99\n").error.find("version '99'") != std::string::npos);
    CHECK(parseKnowledge("# gnomon knowledge 7\ndevice,driver\n").error == "column 'kind' is missing");
    CHECK(parseKnowledge(std::string(kMaxKnowledgeBytes + 1, ' ')).error.find("1 MiB") != std::string::npos);
    const std::string good = "d,v,software,shadow_map,resolve,gpu,9,0.3,0.1,1,,,,,,2,,,,,\n";
    REQUIRE(parseKnowledge(head + good).base->devices.size() == 1);
    for (const auto& [bad, why] :
         {std::pair{"d,v,software,shadow_map,resolve,gpu,9,0.3,nan,1,,,,,,2,,,,,\n",
                    "line 3: fixed_ms 'nan' is no measurement"},
          {"d,v,software,shadow_map,resolve,gpu,9,0.3,1e30,1,,,,,,2,,,,,\n",
           "line 3: fixed_ms '1e30' is no measurement"},
          {"d,v,software,shadow_map,resolve,gpu,9,-0.3,0.1,1,,,,,,2,,,,,\n",
           "line 3: octaves '-0.3' is no measurement"},
          {"d,v,software,shadow_map,resolve,tpu,9,0.3,0.1,1,,,,,,2,,,,,\n",
           "line 3: processor 'tpu' is neither gpu nor cpu"},
          {"d,v,software,shadow_map,resolve,gpu,9,0.3,,,,,,,,,,,,,\n", "line 3: no time was measured"},
          {"d,v,software,shadow_map,cook,gpu,9,0.3,0.1,1,,,,,,2,,,,,\n",
           "line 3: pass 'cook' is none of update, resolve, method and view:NAME"},
          {"d,v,software,shadow_map,view:,gpu,9,0.3,0.1,1,,,,,,2,,,,,\n",
           "line 3: pass 'view:' is none of update, resolve, method and view:NAME"},
          {"d,v,toaster,shadow_map,resolve,gpu,9,0.3,0.1,1,,,,,,2,,,,,\n",
           "line 3: kind 'toaster' is none of software, integrated and discrete"},
          {"d,v\n", "line 3: not as many cells as columns"},
          {"\"\n", "line 3: an open quote"}}) {
        const KnowledgeResult result = parseKnowledge(head + bad + good + good + bad);
        CHECK_FALSE(result.base);
        CHECK(result.error == why);
        const KnowledgeResult later = parseKnowledge(head + good + "# a remark\n\n" + bad);
        CHECK_FALSE(later.base);
        CHECK(later.error.starts_with("line 6: "));
    }
    Random random(10);
    for (int round = 0; round < 3000; ++round) { // nothing crashes, nothing not finite gets through
        std::string text = head + good + good;
        for (uint32_t i = random.below(6); i < 6; ++i)
            text[random.below(static_cast<uint32_t>(text.size()))] = static_cast<char>(random.below(256));
        text.resize(random.below(static_cast<uint32_t>(text.size() + 1)));
        if (const KnowledgeResult result = parseKnowledge(text); result.base)
            for (const DeviceKnowledge& device : result.base->devices)
                for (const AlgorithmCost& cost : device.algorithms)
                    for (const TrackCost& track : cost.tracks)
                        for (const double ms : track.ms)
                            CHECK((std::isfinite(ms) && ms >= 0.0));
    }
}
