// meshfront-view: streams a mesh from a service and draws it, in a window or without one.
#include "shared/program/interrupt.h"
#include "viewer/headless_run.h"
#include "viewer/path_run.h"
#include "viewer/view_options.h"
#include "viewer/window_run.h"

int main(int argc, char** argv) {
  const meshfront::ParsedOptions parsed = meshfront::parseViewOptions(argc, argv);
  if (parsed.exitCode) return *parsed.exitCode;
  meshfront::catchInterrupts();
  if (parsed.options.path) return meshfront::runPath(parsed.options);
  return parsed.options.headless ? meshfront::runHeadless(parsed.options)
                                 : meshfront::runWindow(parsed.options);
}
