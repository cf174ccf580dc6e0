// The section `hand`.
#include "io/fields/sections.hpp"

namespace stillbase::io {

void hand_fields(Table& t, HandSpec& hand) {
  t("constraint", Word(hand.constraint, kHandConstraintNames),
    "`none` (a contact feature is then reached by a free `base_position` alone), `position`, "
    "`axis` (position, and approach axis against the normal), `pose` (all axes)");
  t("position",
    Either({Instead("feature", !hand.position), Vector(hand.position, Dimension::Length)}),
    "where the hand's origin must be (beside a stated `impact.direction`), or `feature` (the "
    "contact feature at the contact time)");
  t("orientation", Either({Instead("feature", !hand.orientation), Orientation(hand.orientation)}),
    "`pose`: of the hand's frame, or `feature` (approach axis against the normal, or against a "
    "stated `impact.direction`)");
  t("frame", Word(hand.frame, kFrameNames), "of position and orientation: `inertial` or `base`");
  t("approach_axis", Vector(hand.approach_axis, VectorKind::Direction),
    "direction in the hand's frame that points out of the hand", {.frame = "hand"});
  t("roll", Number(hand.roll, Dimension::Angle),
    "`pose` without stated orientation: angle about the normal");
}

}  // namespace stillbase::io
