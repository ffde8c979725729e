#include "viewer/gl/ranking_pass.h"

#include <string>
#include <utility>

namespace meshfront {

Result<RankingPass> RankingPass::create(PixelCounter::Method method) {
  auto target = RenderTarget::create({1, 1});
  if (!target) return tl::unexpected(target.error());
  return RankingPass(std::move(*target), PixelCounter::create(method));
}

Result<bool> RankingPass::start(const MeshRenderer& renderer,
                                std::span<const MeshInstance> instances, const RankingView& view,
                                uint64_t tag) {
  if (view.divisor != 1 && view.divisor != 2 && view.divisor != 4)
    return fail("items are drawn at a half or a quarter of the picture's resolution, not at one " +
                std::to_string(view.divisor) + "th");
  if (counter_.underWay() >= PixelCounter::kMostUnderWay) return false;
  const auto share = [&view](int pixels) { return (pixels + view.divisor - 1) / view.divisor; };
  if (auto resized = target_.resize({share(view.size.width), share(view.size.height)}); !resized)
    return tl::unexpected(resized.error());
  FrameState frame = view.frame;
  frame.aspect = view.size.aspect();
  renderer.drawItems(target_, instances, view.camera, view.bounds, view.style, frame);
  return counter_.start(target_, instances, tag,
                        static_cast<uint32_t>(view.divisor * view.divisor));
}

}  // namespace meshfront
