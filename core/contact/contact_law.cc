#include "core/contact/contact_law.h"

#include "core/contact/contact_law-inl.h"

namespace drumsweep {

NormalRow normal_row(const ContactLaw& law, double overlap, double separating_speed, double h) {
  return HWY_NAMESPACE::NormalRowFrom<double>(law, law.stiffness, overlap, separating_speed, h);
}

}  // namespace drumsweep
