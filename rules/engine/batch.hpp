#pragma once

/// Many situations at once, eight by eight: one per light, say. Every number has the bits Engine::evaluate() gives it,
/// with every instruction set and whatever the situations beside it are. For the reasons behind a number evaluate that
/// situation with the engine itself.
///
///     BatchEngine batch(engine);
///     BatchInference all = batch.makeInference(lights);
///     batch.evaluateBatch(facts, lights, all);              // facts[f * lights + i] is fact f of situation i
///     all.quantised[all.at(output, i)]

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "rules/engine/engine.hpp"
#include "runtime/base/instruction_set.hpp"

namespace gnomon::rules {

/// Results in columns: one per output, each with room for `stride` situations.
struct BatchInference {
    uint32_t stride = 0;             ///< A multiple of eight.
    std::vector<double> suitability; ///< Meaningless without an opinion.
    std::vector<int32_t> quantised;  ///< -1 without an opinion, as in OutputState.
    std::vector<uint32_t> vetoRule;  ///< kNoRule: not vetoed.
    std::vector<double> floorTruth;  ///< One per situation, as in Inference.

    std::size_t at(uint32_t output, uint32_t situation) const noexcept
    {
        return std::size_t(output) * stride + situation;
    }

    std::vector<double> scratch; ///< One block at work.
};

class BatchEngine {
public:
    /// Keeps a reference to `engine`.
    explicit BatchEngine(const Engine& engine, InstructionSet set = bestInstructionSet());
    ~BatchEngine();
    BatchEngine(BatchEngine&&) noexcept;
    BatchEngine& operator=(BatchEngine&&) noexcept;

    /// Room for `capacity` situations.
    BatchInference makeInference(uint32_t capacity) const;

    /// `facts` holds one column per fact of the engine, each of `count` numbers. `count` must not exceed the capacity.
    /// Allocates nothing.
    void evaluateBatch(std::span<const double> facts, uint32_t count, BatchInference& out) const noexcept;

private:
    struct Tables;
    class TableMaker;
    void evaluateInMode(std::span<const double> facts, uint32_t count, BatchInference& out) const noexcept;
    void takeCentroids(const double* terms, uint32_t output, BatchInference& out, uint32_t begin) const noexcept;

    const Engine* engine_;
    std::unique_ptr<const Tables> tables_;
};

} // namespace gnomon::rules
