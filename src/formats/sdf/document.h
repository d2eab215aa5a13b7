#pragma once
/// One SDF file with everything it includes, as one tree of the newest form of SDF that we know (1.9).
///
/// <include> is replaced by the model it names, so that all later checks see one tree in which each element still
/// knows the file and line it came from. What older versions say differently is rewritten: pose/@frame, axis/
/// use_parent_model_frame, physics/gravity.
#include "formats/sdf/sdf.h"
#include "formats/sdf/values.h"

namespace sandlot::formats {

/// The minor number of version "1.x" of an <sdf> element; a warning for those that are not wholly understood.
Result<int> version_of(const Xml& root, Notes& notes);
/// Rewrites what differs in version 1.`minor` from 1.9. The changes are those of libsdformat's *.convert files.
void modernise(Xml& element, int minor);

/// Makes an <actor> a <model> with the attribute `sandlot:actor`; one without a link gets a capsule the size of a person.
void stand_in_for_actor(Xml& actor);

/// The elements that take the place of an `<include merge="true">`: those of `model`, in the frame and under the proxy
/// frame that SDF 1.9 prescribes.
Result<std::vector<Xml>> merged(const Xml& include, const Xml& model);

/// The <sdf> element of `text`, includes resolved.
/// Search   files/resources.h
Result<Xml> load_document(std::string_view text, const std::string& file, Notes& notes,
                          const SdfOptions& options);

}  // namespace sandlot::formats
