#define GNOMON_LANE_BYTES 32
#include "rules/engine/batch_kernel.inl"

namespace gnomon::rules::batch {

void runAvx2(const Program& program, const Block& block)
{
    runKernel(program, block);
}

} // namespace gnomon::rules::batch
