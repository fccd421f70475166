#include "render/gl_context.h"

#include <thread>

#include <gtest/gtest.h>

namespace windhover {
namespace {

TEST(OsMesaContext, OffersAtLeastGl33) {
  const std::unique_ptr<GlContext> context = MakeOsMesaContext();
  context->MakeCurrent();
  const std::string text = DescribeGl(*context);
  int major = 0, minor = 0;
  ASSERT_EQ(std::sscanf(text.c_str(), "OpenGL %d.%d", &major, &minor), 2) << text;
  EXPECT_GE(major * 10 + minor, 33);
}

TEST(OsMesaContext, ServesSeveralThreadsAtOnce) {
  const auto clear = [] {
    const std::unique_ptr<GlContext> context = MakeOsMesaContext();
    context->MakeCurrent();
    const GlFunctions& gl = context->gl();
    gl.ClearColor(0, 1, 0, 1);
    gl.Clear(GL_COLOR_BUFFER_BIT);
    unsigned char pixel[4] = {};
    gl.ReadPixels(3, 3, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
    EXPECT_EQ(pixel[1], 255);
  };
  std::jthread first(clear), second(clear);
}

}  // namespace
}  // namespace windhover
