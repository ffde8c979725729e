// SIGINT and SIGTERM ask a program to end; its loop looks whether they did.
#pragma once

namespace meshfront {

void catchInterrupts();  // once, before threads start
[[nodiscard]] bool interrupted();

}  // namespace meshfront
