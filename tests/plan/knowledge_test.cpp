#include <cmath>
#include <doctest/doctest.h>
#include <string>
#include <vector>

#include "runtime/cost/cost_model.hpp"
#include "runtime/cost/knowledge_base.hpp"
#include "tests/plan/cost_truth.hpp"

using namespace gnomon::cost;
using namespace gnomon::cost::test;

TEST_CASE("a knowledge base reads back as it was written, and teaches the model")
{
    Random random(9);
    std::vector<KnowledgeRow> rows;
    for (int i = 0; i < 60; ++i)
        rows.push_back({.device = "a, \"b\"",
                        .driver = "d",
                        .algorithm = i % 2 ? "shadow_map" : "ray_traced",
                        .pass = i % 4 < 2 ? Pass::update : Pass::resolve,
                        .workload = anyWorkload(random),
                        .samples = 5,
                        .gpuMsP50 = random.between(0.1, 3),
                        .gpuMsP95 = 4.5,
                        .date = "2026-01-01"});
    const std::string text = writeKnowledge(rows);
    const KnowledgeResult read = parseKnowledge(text);
    REQUIRE(read.base);
    CHECK(read.base->rejected == 0);
    CHECK(writeKnowledge(read.base->rows) == text);
    CHECK(parseKnowledge("\xef\xbb\xbf" + text).base); // as editors mark UTF-8
    CHECK(read.base->rows[7].gpuMsP50 == doctest::Approx(rows[7].gpuMsP50).epsilon(1e-6));
    CHECK(read.base->rows[7].device == rows[7].device);

    const std::vector<std::string> methods{"ray_traced", "other"};
    CostModel model;
    model.resize(2, 1);
    const Learned home = learn(model, *read.base, methods, rows[0].device);
    CHECK(home.rows == 30);
    CHECK(home.sameDevice);
    CHECK(model.predict(0, 0, rows[0].workload, false).calibrated);
    CHECK_FALSE(model.predict(0, 1, rows[0].workload, false).calibrated);
    CostModel elsewhere;
    elsewhere.resize(2, 1);
    CHECK_FALSE(learn(elsewhere, *read.base, methods, "another").sameDevice);
}

TEST_CASE("what lights of a view share is read back too, and teaches no light")
{
    const std::vector<KnowledgePart> parts{{.device = "d",
                                            .driver = "v",
                                            .algorithm = "stencil_volume",
                                            .pass = "volumes.strips, all",
                                            .viewPixels = 921600,
                                            .samples = 12,
                                            .gpuMs = 1.5,
                                            .date = "2026-01-01"},
                                           {.device = "d",
                                            .algorithm = "tile_shafts",
                                            .pass = "view.hulls",
                                            .viewPixels = 1000,
                                            .samples = 3,
                                            .cpuMs = 0.25}};
    const std::string text = writeKnowledge({}, parts);
    const KnowledgeResult read = parseKnowledge(text);
    REQUIRE(read.base);
    CHECK(read.base->findings.empty());
    CHECK(read.base->rows.empty());
    REQUIRE(read.base->parts.size() == 2);
    CHECK(read.base->parts[0].pass == "volumes.strips, all");
    CHECK(read.base->parts[0].viewPixels == 921600);
    CHECK(read.base->parts[0].gpuMs == 1.5);
    CHECK(read.base->parts[1].cpuMs == 0.25);
    CHECK(writeKnowledge({}, read.base->parts) == text);
    CostModel model;
    model.resize(1, 1);
    const std::vector<std::string> methods{"stencil_volume"};
    CHECK(learn(model, *read.base, methods, "d").rows == 0);

    std::string flat = text;
    flat.replace(flat.find(",921600,"), 8, ",0,");
    CHECK(parseKnowledge(flat).base->findings.at(0) == "line 3: view_pixels is not a size");
    std::string nameless = text;
    nameless.replace(nameless.find("\"view:volumes.strips, all\""), 26, "view:");
    CHECK(parseKnowledge(nameless).base->rejected == 1);
}

TEST_CASE("a damaged knowledge base is an error or loses only its damaged rows")
{
    const std::string head = writeKnowledge({});
    CHECK(parseKnowledge(head).base->rows.empty()); // an empty one is fine
    CHECK_FALSE(parseKnowledge("").base);
    CHECK_FALSE(parseKnowledge("# gnomon knowledge 0\n").base);
    CHECK(parseKnowledge("# gnomon knowledge 99\n").error.find("version '99'") != std::string::npos);
    CHECK(parseKnowledge("# gnomon knowledge 4\ndevice,driver\n").error == "column 'algorithm' is missing");
    const std::string good =
        "d,v,shadow_map,resolve,1000,10,0,1,0,10,1,0,0,900,2000,700,4,0.5,1,5,1,1.5,2,0,0,0,0,0,2026\n";
    for (const char* bad :
         {"d,v,shadow_map,resolve,nan,10,0,1,0,10,1,0,0,900,2000,700,4,0.5,1,5,1,1.5,2,0,0,0,0,0,2026\n",
          "d,v,shadow_map,resolve,1000,10,0,1,0,10,1,0,0,900,2000,700,4,0.5,1,5,1,inf,2,0,0,0,0,0,2026\n",
          "d,v,shadow_map,resolve,1000,10,0,1,0,10,1,0,0,900,2000,700,4,0.5,1,5,1,-1,2,0,0,0,0,0,2026\n",
          "d,v,shadow_map,resolve,1000,10,0,1,0,10,1,0,0,900,2000,700,4,0.5,1,5,1,\"1,5\",2,0,0,0,0,0,2026\n",
          "d,v,shadow_map,resolve,1000,10,0,1,0,10,1,0,0,900,2000,700,4,0.5,1,5,0,0,2,0,0,0,0,0,2026\n",
          "d,v,shadow_map,cook,1000,10,0,1,0,10,1,0,0,900,2000,700,4,0.5,1,5,1,1,2,0,0,0,0,0,2026\n", "d,v\n",
          "\"\n"}) {
        const KnowledgeResult result = parseKnowledge(head + bad + good);
        REQUIRE(result.base);
        CHECK(result.base->rows.size() == 1);
        CHECK(result.base->rejected == 1);
        CHECK(result.base->findings.at(0).starts_with("line 3: "));
    }
    Random random(10);
    for (int round = 0; round < 3000; ++round) { // nothing crashes, nothing not finite gets through
        std::string text = head + good + good;
        for (uint32_t i = random.below(6); i < 6; ++i)
            text[random.below(static_cast<uint32_t>(text.size()))] = static_cast<char>(random.below(256));
        text.resize(random.below(static_cast<uint32_t>(text.size() + 1)));
        if (const KnowledgeResult result = parseKnowledge(text); result.base)
            for (const KnowledgeRow& row : result.base->rows)
                CHECK(std::isfinite(row.gpuMsP50 + row.cpuMsP50 + row.workload.pixels));
    }
}
