// Backends of a build without the simulator (SUREFOOT_WITH_SIM=OFF): replay only.
#include "apps/common/backend.h"

namespace surefoot::apps {

std::vector<std::string> backend_names() { return {}; }

std::unique_ptr<Backend> make_backend(const RunRequest& request, const Config&) {
  throw BackendError("--hal: '" + request.hal + "' is not in this build; it can only replay");
}

}  // namespace surefoot::apps
