// make_test_model OUT [ID] [SEED] [GAIN] [FAMILY]: writes a model file with random weights, for tests that need one. It
// is of IH21, or of the family FAMILY, whose definition in the model is that of IH21 under another id.

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "supple/tiling/definition_text.h"
#include "support/test_calibration.h"
#include "support/test_model.h"

int main(int argc, char** argv) {
  if (argc < 2 || argc > 6) {
    std::fprintf(stderr, "usage: make_test_model OUT [ID] [SEED] [GAIN] [FAMILY]\n");
    return 1;
  }
  try {
    const char* const id = argc > 2 ? argv[2] : "ih21";
    const std::uint64_t seed = argc > 3 ? std::strtoull(argv[3], nullptr, 10) : 1;
    const double gain = argc > 4 ? std::strtod(argv[4], nullptr) : 1;
    auto model = supple::test::test_model(id, seed, gain);
    model.calibration = supple::test::test_calibration(model.network.shape.parameters);
    if (argc > 5) {
      auto definition = *supple::tiling::family("IH21").definition;
      definition.id = model.family = argv[5];
      model.definition = supple::tiling::to_text(definition);
    }
    supple::neural::write_model(argv[1], model);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_test_model: %s\n", error.what());
    return 1;
  }
}
