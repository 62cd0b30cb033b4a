#pragma once
// Visibility that host passes write: receivers read back, rows in upload memory, a copy into the light's layer.
#include "algorithms/shared/receivers.hpp"
#include "runtime/algorithm.hpp"

namespace gnomon {

/// The buffers of a host pass that answers all pixels of the task's area.
struct HostVisibility {
    BufferId depth, normals; ///< Of the view, read back; normals may be null.
    BufferId rows;           ///< One byte a pixel of the area: 0 dark, 255 lit.
};

/// Declares the buffers. @param name of the rows, "algorithm.visibility".
HostVisibility declareHostVisibility(PassBuilder& passes, const ShadowTask& task, const char* name);

/// Device bytes of the rows, for AlgorithmEntry::memoryPerLight; the view's receivers are shared by its lights.
VkDeviceSize hostVisibilityMemory(VkExtent2D extent);

/// What the host pass reads and writes.
void useHostVisibility(PassRef& pass, const HostVisibility& buffers);

/// The view's receivers, in the host pass.
Receivers receiversOf(const CameraView& view, const LightView& light, const HostVisibility& buffers,
                      const HostContext& host);

/// Declares the pass that copies the rows to task.visibility. @param name "algorithm.copy".
void declareVisibilityCopy(PassBuilder& passes, const ShadowTask& task, const HostVisibility& buffers,
                           const char* name);

/// Some of its pixels, of any extent; in the buffer they lie row by row without gaps.
void declareVisibilityCopy(PassBuilder& passes, const ShadowTask& task, BufferId bytes, const VkRect2D& pixels,
                           const char* name);
/// And from there to a buffer that the host reads.
void declareVisibilityReadback(PassBuilder& passes, const ShadowTask& task, BufferId bytes, const VkRect2D& pixels,
                               const char* name);

} // namespace gnomon
