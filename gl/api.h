/* The OpenGL entry points that the renderer uses: one list, loaded at run time.
 *
 * libOSMesa exports only OpenGL 1.x by name, so nothing of GL is linked. */
#ifndef PEEL_GL_API_H
#define PEEL_GL_API_H

#include "base/result.h"

#include <GL/glcorearb.h>

/* X(name in capitals as in glcorearb.h's typedef, name). */
#define API_FUNCTIONS(X)                                                                           \
    X(ATTACHSHADER, AttachShader)                                                                  \
    X(BEGINQUERY, BeginQuery)                                                                      \
    X(BINDBUFFERBASE, BindBufferBase)                                                              \
    X(BINDFRAMEBUFFER, BindFramebuffer)                                                            \
    X(BINDIMAGETEXTURE, BindImageTexture)                                                          \
    X(BINDTEXTUREUNIT, BindTextureUnit)                                                            \
    X(BINDVERTEXARRAY, BindVertexArray)                                                            \
    X(BLENDEQUATION, BlendEquation)                                                                \
    X(BLENDEQUATIONI, BlendEquationi)                                                              \
    X(BLENDEQUATIONSEPARATE, BlendEquationSeparate)                                                \
    X(BLENDFUNC, BlendFunc)                                                                        \
    X(BLENDFUNCI, BlendFunci)                                                                      \
    X(BLENDFUNCSEPARATE, BlendFuncSeparate)                                                        \
    X(CHECKNAMEDFRAMEBUFFERSTATUS, CheckNamedFramebufferStatus)                                    \
    X(CLAMPCOLOR, ClampColor)                                                                      \
    X(CLEARNAMEDBUFFERDATA, ClearNamedBufferData)                                                  \
    X(CLEARNAMEDFRAMEBUFFERFV, ClearNamedFramebufferfv)                                            \
    X(CLEARNAMEDFRAMEBUFFERUIV, ClearNamedFramebufferuiv)                                          \
    X(CLIPCONTROL, ClipControl)                                                                    \
    X(COMPILESHADER, CompileShader)                                                                \
    X(CREATEBUFFERS, CreateBuffers)                                                                \
    X(CREATEFRAMEBUFFERS, CreateFramebuffers)                                                      \
    X(CREATEPROGRAM, CreateProgram)                                                                \
    X(CREATEQUERIES, CreateQueries)                                                                \
    X(CREATESHADER, CreateShader)                                                                  \
    X(CREATETEXTURES, CreateTextures)                                                              \
    X(CREATEVERTEXARRAYS, CreateVertexArrays)                                                      \
    X(DEBUGMESSAGECALLBACK, DebugMessageCallback)                                                  \
    X(DELETEBUFFERS, DeleteBuffers)                                                                \
    X(DELETEFRAMEBUFFERS, DeleteFramebuffers)                                                      \
    X(DELETEPROGRAM, DeleteProgram)                                                                \
    X(DELETEQUERIES, DeleteQueries)                                                                \
    X(DELETESHADER, DeleteShader)                                                                  \
    X(DELETETEXTURES, DeleteTextures)                                                              \
    X(DELETEVERTEXARRAYS, DeleteVertexArrays)                                                      \
    X(DEPTHFUNC, DepthFunc)                                                                        \
    X(DEPTHMASK, DepthMask)                                                                        \
    X(DETACHSHADER, DetachShader)                                                                  \
    X(DISABLE, Disable)                                                                            \
    X(DRAWARRAYS, DrawArrays)                                                                      \
    X(DRAWELEMENTSBASEVERTEX, DrawElementsBaseVertex)                                              \
    X(ENABLE, Enable)                                                                              \
    X(ENABLEVERTEXARRAYATTRIB, EnableVertexArrayAttrib)                                            \
    X(ENDQUERY, EndQuery)                                                                          \
    X(FINISH, Finish)                                                                              \
    X(GETERROR, GetError)                                                                          \
    X(GETINTEGERV, GetIntegerv)                                                                    \
    X(GETNAMEDBUFFERSUBDATA, GetNamedBufferSubData)                                                \
    X(GETNAMEDFRAMEBUFFERPARAMETERIV, GetNamedFramebufferParameteriv)                              \
    X(GETPROGRAMINFOLOG, GetProgramInfoLog)                                                        \
    X(GETPROGRAMIV, GetProgramiv)                                                                  \
    X(GETQUERYOBJECTUI64V, GetQueryObjectui64v)                                                    \
    X(GETSHADERINFOLOG, GetShaderInfoLog)                                                          \
    X(GETSHADERIV, GetShaderiv)                                                                    \
    X(GETSTRING, GetString)                                                                        \
    X(LINKPROGRAM, LinkProgram)                                                                    \
    X(MEMORYBARRIER, MemoryBarrier)                                                                \
    X(NAMEDBUFFERSTORAGE, NamedBufferStorage)                                                      \
    X(NAMEDBUFFERSUBDATA, NamedBufferSubData)                                                      \
    X(NAMEDFRAMEBUFFERDRAWBUFFERS, NamedFramebufferDrawBuffers)                                    \
    X(NAMEDFRAMEBUFFERREADBUFFER, NamedFramebufferReadBuffer)                                      \
    X(NAMEDFRAMEBUFFERTEXTURE, NamedFramebufferTexture)                                            \
    X(PIXELSTOREI, PixelStorei)                                                                    \
    X(PROGRAMUNIFORM1F, ProgramUniform1f)                                                          \
    X(PROGRAMUNIFORM1I, ProgramUniform1i)                                                          \
    X(PROGRAMUNIFORM1UI, ProgramUniform1ui)                                                        \
    X(PROGRAMUNIFORM3FV, ProgramUniform3fv)                                                        \
    X(PROGRAMUNIFORM4FV, ProgramUniform4fv)                                                        \
    X(PROGRAMUNIFORM4IV, ProgramUniform4iv)                                                        \
    X(PROGRAMUNIFORMMATRIX3FV, ProgramUniformMatrix3fv)                                            \
    X(PROGRAMUNIFORMMATRIX4FV, ProgramUniformMatrix4fv)                                            \
    X(READPIXELS, ReadPixels)                                                                      \
    X(SHADERSOURCE, ShaderSource)                                                                  \
    X(TEXTUREPARAMETERI, TextureParameteri)                                                        \
    X(TEXTURESTORAGE2D, TextureStorage2D)                                                          \
    X(TEXTURESUBIMAGE2D, TextureSubImage2D)                                                        \
    X(USEPROGRAM, UseProgram)                                                                      \
    X(VERTEXARRAYATTRIBBINDING, VertexArrayAttribBinding)                                          \
    X(VERTEXARRAYATTRIBFORMAT, VertexArrayAttribFormat)                                            \
    X(VERTEXARRAYELEMENTBUFFER, VertexArrayElementBuffer)                                          \
    X(VERTEXARRAYVERTEXBUFFER, VertexArrayVertexBuffer)                                            \
    X(VIEWPORT, Viewport)

typedef struct Api {
#define API_FIELD(upper, name) PFNGL##upper##PROC name;
    API_FUNCTIONS(API_FIELD)
#undef API_FIELD
} Api;

/* Valid after api_load; one table per process, as OSMesa dispatches to the current context. */
extern Api gl;

typedef void (*ApiFunction)(void);

/* Fills gl through lookup. NO_GL names the first entry point that is missing. */
Result api_load(ApiFunction (*lookup)(const char *name));

#endif
