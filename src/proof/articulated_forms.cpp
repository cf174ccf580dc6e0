#include "proof/articulated_forms.hpp"

namespace stillbase::proof {

template struct ArticulatedForms<Form<2>>;
template struct ArticulatedForms<Form<3>>;

}  // namespace stillbase::proof
