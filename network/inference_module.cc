#include "network/inference.h"
#include "network/onednn_engine.h"
#include "network/onnx_parser.h"
#include "network/opencv_engine.h"

extern "C" {
extern const windhover::InferenceLibrary windhover_inference;
const windhover::InferenceLibrary windhover_inference = {
    windhover::ParseOnnx, windhover::MakeOneDnnEngine, windhover::MakeOpenCvEngine};
}
