#pragma once
// The second half of a map-and-rays hybrid where the device traces rays: UNDECIDED pixels are listed and traced there,
// and nothing goes through the CPU.
#include "algorithms/hybrid/device_trace.hpp"
#include "algorithms/hybrid/undecided.hpp"

namespace gnomon {

class UndecidedOnDevice {
public:
    /// @pre DeviceTable::rayQuery()
    UndecidedOnDevice(const AlgorithmServices& services, const UndecidedNames& names);

    /// As declareUndecided(). @param reasons answers are REASON_RT_LIT and REASON_RT_SHADOW
    void declare(PassBuilder& passes, const ShadowTask& task, bool reasons, const Doubt& doubt = {}) const;

    /// Device bytes for a view: the list.
    static VkDeviceSize memory(VkExtent2D extent);

private:
    UndecidedNames names_;
    PipelineId find_;
    DeviceTrace trace_;
};

} // namespace gnomon
