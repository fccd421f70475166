#pragma once

#include <GL/glcorearb.h>

namespace windhover {

// Every function of OpenGL 3.3 core that render/ calls: F(pointer type, name without "gl").
#define WINDHOVER_GL_FUNCTIONS(F)                              \
  F(PFNGLATTACHSHADERPROC, AttachShader)                       \
  F(PFNGLBINDBUFFERPROC, BindBuffer)                           \
  F(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                 \
  F(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer)               \
  F(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                 \
  F(PFNGLBLENDFUNCPROC, BlendFunc)                             \
  F(PFNGLBUFFERDATAPROC, BufferData)                           \
  F(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus)   \
  F(PFNGLCLEARPROC, Clear)                                     \
  F(PFNGLCLEARCOLORPROC, ClearColor)                           \
  F(PFNGLCOMPILESHADERPROC, CompileShader)                     \
  F(PFNGLCREATEPROGRAMPROC, CreateProgram)                     \
  F(PFNGLCREATESHADERPROC, CreateShader)                       \
  F(PFNGLCULLFACEPROC, CullFace)                               \
  F(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                     \
  F(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)           \
  F(PFNGLDELETEPROGRAMPROC, DeleteProgram)                     \
  F(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers)         \
  F(PFNGLDELETESHADERPROC, DeleteShader)                       \
  F(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)           \
  F(PFNGLDEPTHFUNCPROC, DepthFunc)                             \
  F(PFNGLDEPTHMASKPROC, DepthMask)                             \
  F(PFNGLDISABLEPROC, Disable)                                 \
  F(PFNGLDRAWELEMENTSPROC, DrawElements)                       \
  F(PFNGLENABLEPROC, Enable)                                   \
  F(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray) \
  F(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer) \
  F(PFNGLFRONTFACEPROC, FrontFace)                             \
  F(PFNGLGENBUFFERSPROC, GenBuffers)                           \
  F(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)                 \
  F(PFNGLGENRENDERBUFFERSPROC, GenRenderbuffers)               \
  F(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)                 \
  F(PFNGLGETERRORPROC, GetError)                               \
  F(PFNGLGETPROGRAMIVPROC, GetProgramiv)                       \
  F(PFNGLGETSTRINGPROC, GetString)                             \
  F(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)           \
  F(PFNGLLINKPROGRAMPROC, LinkProgram)                         \
  F(PFNGLPIXELSTOREIPROC, PixelStorei)                         \
  F(PFNGLREADPIXELSPROC, ReadPixels)                           \
  F(PFNGLRENDERBUFFERSTORAGEPROC, RenderbufferStorage)         \
  F(PFNGLSCISSORPROC, Scissor)                                 \
  F(PFNGLSHADERSOURCEPROC, ShaderSource)                       \
  F(PFNGLUNIFORM4FPROC, Uniform4f)                             \
  F(PFNGLUSEPROGRAMPROC, UseProgram)                           \
  F(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)         \
  F(PFNGLVIEWPORTPROC, Viewport)

/// Pointers to the functions of one GL implementation: `gl.Clear(…)` is glClear(…).
struct GlFunctions {
#define WINDHOVER_GL_MEMBER(type, name) type name = nullptr;
  WINDHOVER_GL_FUNCTIONS(WINDHOVER_GL_MEMBER)
#undef WINDHOVER_GL_MEMBER
};

}  // namespace windhover
