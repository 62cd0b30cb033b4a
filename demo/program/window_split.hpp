#pragma once
// The same frame once more by `ray_traced`, with a context of its own, to be seen right of a divider: its picture, or
// the errors against it.

#include "demo/program/picture_views.hpp"
#include "demo/program/session.hpp"

namespace gnomon::demo {

class SplitView {
public:
    /// Throws HostError where `ray_traced` serves none of the lights, or is not in the build. \param session outlives
    /// this, and draws the frames that show() is called in.
    explicit SplitView(Session& session, const RunOptions& options);

    /// Before the session's frame.
    void draw(double time, const CameraState& camera, VkExtent2D extent);
    /// Within the session's frame, over its picture, which is in TRANSFER_SRC_OPTIMAL before and after.
    /// \param divider share of the width.
    void show(VkCommandBuffer cmd, const Image& picture, double divider) const;
    /// Before showErrors(). Throws HostError where the device cannot do it.
    void prepareErrors();
    /// In place of show().
    void showErrors(VkCommandBuffer cmd, double divider);
    /// Of the errors that the frame before the newest draw() showed, percent; empty: it showed none.
    std::optional<double> wrongPercent() const noexcept { return wrongPercent_; }

private:
    Session& session_;
    Session truth_;
    std::optional<ErrorView> errors_;
    bool readsTruth_ = false; ///< The session's newest frame reads what the truth drew.
    std::optional<double> wrongPercent_;
};

} // namespace gnomon::demo
