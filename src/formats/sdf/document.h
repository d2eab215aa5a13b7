#pragma once
/// One SDF file with everything it includes, as one tree of the newest form of SDF that we know (1.9).
///
/// <include> is replaced by the model it names, so that all later checks see one tree in which each element still
/// knows the file and line it came from. What older versions say differently is rewritten: pose/@frame, axis/
/// use_parent_model_frame, physics/gravity.
#include "formats/sdf/sdf.h"
#include "formats/sdf/values.h"

namespace sandlot::formats {

/// The <sdf> element of `text`, includes resolved.
/// Search   formats/resources.h
Result<Xml> load_document(std::string_view text, const std::string& file, Notes& notes,
                          const SdfOptions& options);

}  // namespace sandlot::formats
