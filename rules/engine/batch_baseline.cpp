#define GNOMON_LANE_BYTES 16
#include "rules/engine/batch_kernel.inl"

namespace gnomon::rules::batch {

void runBaseline(const Program& program, const Block& block)
{
    runKernel(program, block);
}

} // namespace gnomon::rules::batch
