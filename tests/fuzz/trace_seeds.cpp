// Writes small traces into a folder, as a corpus to start from: trace_seeds FOLDER

#include <cstdio>
#include <fstream>
#include <string>

#include "demo/replay/synthetic.hpp"

using namespace gnomon::demo;

int main(int argc, char** argv)
{
    if (argc != 2) return std::fprintf(stderr, "usage: trace_seeds FOLDER\n"), 2;
    constexpr SyntheticKind kKinds[] = {SyntheticKind::still, SyntheticKind::slowWalk, SyntheticKind::stress,
                                        SyntheticKind::budgetStep};
    int number = 0;
    for (const SyntheticKind kind : kKinds)
        for (const uint32_t frames : {1u, 4u}) {
            const std::string bytes = writeTrace(syntheticTrace({.kind = kind, .frames = frames, .lights = 1 + frames}));
            std::ofstream(std::string(argv[1]) + "/seed" + std::to_string(number++), std::ios::binary) << bytes;
        }
    return 0;
}
