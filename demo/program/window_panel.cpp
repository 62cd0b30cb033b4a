#include "demo/program/window_panel.hpp"

#include <algorithm>
#include <fstream>
#include <utility>
#include <vector>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <gnomon/gnomon_imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_vulkan.h>

#include "demo/io/font.hpp"
#include "demo/program/window_controls.hpp"

namespace gnomon::demo {

namespace {

/// The pass was a parameter until it became a member, between two releases 1.90.x.
template <typename Info>
void startBackend(Info& info, VkRenderPass pass)
{
    if constexpr (requires { info.RenderPass; }) {
        info.RenderPass = pass;
        ImGui_ImplVulkan_Init(&info);
    } else {
        ImGui_ImplVulkan_Init(&info, pass);
    }
}

/// Loads and stores a picture that was and will be copied.
VkRenderPass makePass(const Device& device, VkFormat format)
{
    constexpr VkImageLayout copied = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    const VkAttachmentDescription picture{.format = format,
                                          .samples = VK_SAMPLE_COUNT_1_BIT,
                                          .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
                                          .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                          .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                          .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                          .initialLayout = copied,
                                          .finalLayout = copied};
    const VkAttachmentReference drawn{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
    const VkSubpassDescription subpass{
        .pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS, .colorAttachmentCount = 1, .pColorAttachments = &drawn};
    constexpr VkAccessFlags attached = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
    const VkSubpassDependency order[] = {{.srcSubpass = VK_SUBPASS_EXTERNAL,
                                          .dstSubpass = 0,
                                          .srcStageMask = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                                          .dstStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                                          .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                          .dstAccessMask = attached},
                                         {.srcSubpass = 0,
                                          .dstSubpass = VK_SUBPASS_EXTERNAL,
                                          .srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                                          .dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT,
                                          .srcAccessMask = attached,
                                          .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT}};
    const VkRenderPassCreateInfo info{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                      .attachmentCount = 1,
                                      .pAttachments = &picture,
                                      .subpassCount = 1,
                                      .pSubpasses = &subpass,
                                      .dependencyCount = 2,
                                      .pDependencies = order};
    VkRenderPass pass = VK_NULL_HANDLE;
    vkCheck(vkCreateRenderPass(device.handle, &info, nullptr, &pass), "vkCreateRenderPass");
    return pass;
}

VkDescriptorPool makePool(const Device& device)
{
    const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1};
    const VkDescriptorPoolCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                          .flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT,
                                          .maxSets = 1,
                                          .poolSizeCount = 1,
                                          .pPoolSizes = &size};
    VkDescriptorPool pool = VK_NULL_HANDLE;
    vkCheck(vkCreateDescriptorPool(device.handle, &info, nullptr, &pool), "vkCreateDescriptorPool");
    return pool;
}

/// Letters and spaces in proportion to the display's scale.
/// \return the scale: 1 at 96 dots an inch.
float scaleTo(GLFWwindow* window)
{
    float scale = 1.0f, vertical = 1.0f;
    glfwGetWindowContentScale(window, &scale, &vertical);
    scale = std::clamp(scale, 1.0f, 4.0f); // a display that does not know its size may say anything
    ImGui::GetStyle().ScaleAllSizes(scale);
    ImFontConfig config;
    config.SizePixels = 13.0f * scale; // of ImGui's own font, which was drawn for 13
    ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
    if (const char* const file = fontFile(); !std::ifstream(file) || !fonts.AddFontFromFileTTF(file, 14.0f * scale))
        fonts.AddFontDefault(&config);
    return scale;
}

/// The rules' variables as the panel draws them.
std::vector<ImguiVariable> variablesOf(const rules::RuleBase* base)
{
    std::vector<ImguiVariable> variables;
    if (!base) return variables;
    for (const rules::Variable& variable : base->variables) {
        variables.push_back({variable.name, variable.low, variable.high, {}});
        for (const rules::Term& term : variable.terms)
            variables.back().terms.push_back({term.name, term.shape.a, term.shape.b, term.shape.c, term.shape.d});
    }
    return variables;
}

} // namespace

struct WindowPanel::Parts {
    using UniquePass = Unique<VkRenderPass, &vkDestroyRenderPass>;
    using UniqueFramebuffer = Unique<VkFramebuffer, &vkDestroyFramebuffer>;

    Session& session;
    WindowSettings& settings;
    WindowRules& rules;
    UniquePass pass;
    UniqueDescriptorPool pool;
    std::vector<UniqueFramebuffer> framebuffers; ///< A frame in flight each.
    uint64_t frame = 0;
    float scale = 1.0f;                ///< Of the display.
    float width = 0.0f, height = 0.0f; ///< Of the display, in the last frame.
    ImguiPanel panel;
    uint32_t rulesVersion = 0; ///< That the panel draws.
    WindowControls controls;
};

WindowPanel::WindowPanel(Session& session, const Window& window, uint32_t framesInFlight, WindowSettings& settings,
                         WindowRules& rules)
    : parts_(new Parts{.session = session,
                       .settings = settings,
                       .rules = rules,
                       .pass = {},
                       .pool = {},
                       .framebuffers = {},
                       .panel = {},
                       .controls = {}})
{
    const Device& device = session.device;
    parts_->pass = {device.handle, makePass(device, Renderer::kColourFormat)};
    parts_->pool = {device.handle, makePool(device)};
    parts_->framebuffers.resize(framesInFlight);
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    parts_->scale = scaleTo(window.handle());
    ImGui_ImplGlfw_InitForVulkan(window.handle(), true);
    ImGui_ImplVulkan_InitInfo info{};
    info.Instance = device.instance;
    info.PhysicalDevice = device.physicalDevice;
    info.Device = device.handle;
    info.QueueFamily = device.queueFamily;
    info.Queue = device.queue;
    info.DescriptorPool = parts_->pool.get();
    info.MinImageCount = info.ImageCount = std::max(framesInFlight, 2u); // sets of its vertex buffers
    startBackend(info, parts_->pass.get());
}

WindowPanel::~WindowPanel()
{
    ImGui_ImplVulkan_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

bool WindowPanel::wantsKeys() const
{
    return ImGui::GetIO().WantCaptureKeyboard;
}

bool WindowPanel::wantsMouse() const
{
    return ImGui::GetIO().WantCaptureMouse;
}

void WindowPanel::draw(VkCommandBuffer cmd, const Image& picture)
{
    Parts& parts = *parts_;
    Session& session = parts.session;
#if IMGUI_VERSION_NUM < 19000
    if (parts.frame == 0) ImGui_ImplVulkan_CreateFontsTexture(cmd);
#endif
    const VkImageView view = picture.view.get();
    const VkFramebufferCreateInfo info{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                       .renderPass = parts.pass.get(),
                                       .attachmentCount = 1,
                                       .pAttachments = &view,
                                       .width = picture.extent.width,
                                       .height = picture.extent.height,
                                       .layers = 1};
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    vkCheck(vkCreateFramebuffer(session.device.handle, &info, nullptr, &framebuffer), "vkCreateFramebuffer");
    // In place of that of the frame that has been waited for.
    parts.framebuffers[parts.frame++ % parts.framebuffers.size()] = {session.device.handle, framebuffer};
    ImGui_ImplVulkan_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    const ImVec2 whole = ImGui::GetIO().DisplaySize;
    const float edge = 10.0f * parts.scale;
    const float above = WindowControls::standsBeside(whole.x, parts.scale) ? 0.0f : edge + ImGui::GetFrameHeight();
    const bool resized = parts.width != whole.x || parts.height != whole.y;
    parts.width = whole.x;
    parts.height = whole.y;
    const ImGuiCond when = resized ? ImGuiCond_Always : ImGuiCond_FirstUseEver;
    ImGui::SetNextWindowPos({edge, edge + above}, when);
    ImGui::SetNextWindowSize(
        {std::min(840.0f * parts.scale, 0.92f * whole.x), std::min(600.0f * parts.scale, 0.8f * whole.y)}, when);
    if (parts.settings.split) {
        const float x = float(parts.settings.divider) * whole.x;
        ImGui::GetBackgroundDrawList()->AddLine({x, 0.0f}, {x, whole.y}, IM_COL32_WHITE, 2.0f * parts.scale);
    }
    if (std::exchange(parts.rulesVersion, parts.rules.version()) != parts.rules.version())
        parts.panel.setVariables(variablesOf(parts.rules.base()));
    std::vector<ImguiLight> lights;
    for (const uint32_t index : session.renderer.state().present)
        lights.push_back({session.shadows.light(index), session.scene.lights[index].name.c_str()});
    parts.panel.draw(session.shadows.context(), session.shadows.view(0), lights.data(),
                     static_cast<uint32_t>(lights.size()));
    parts.controls.draw(parts.settings, parts.rules, parts.scale, resized);
    ImGui::Render();
    const VkRenderPassBeginInfo begin{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                      .renderPass = parts.pass.get(),
                                      .framebuffer = framebuffer,
                                      .renderArea = {{0, 0}, picture.extent}};
    vkCmdBeginRenderPass(cmd, &begin, VK_SUBPASS_CONTENTS_INLINE);
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), cmd);
    vkCmdEndRenderPass(cmd);
}

} // namespace gnomon::demo
