// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/guard/scale_check.h"

#include <array>

#include "store/hdf5/h5.h"

namespace landfall::h5 {
namespace {

struct Form {
  hid_t type;
  int rank;         ///< of the attribute's space
  hssize_t values;  ///< in it
  int scaled_rank;  ///< of the dataset
};

bool is_fixed_text(hid_t type) { return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0; }

bool is_object_reference(hid_t type) { return H5Tequal(type, H5T_STD_REF_OBJ) > 0; }

bool is_list_of_references(const Form& form) {
  if (H5Tget_class(form.type) != H5T_VLEN || form.rank != 1 || form.values != form.scaled_rank) return false;
  const Handle base(H5Tget_super(form.type), H5Tclose);
  return is_object_reference(base.get());
}

bool is_list_of_users(const Form& form) {
  if (H5Tget_class(form.type) != H5T_COMPOUND || H5Tget_nmembers(form.type) != 2 || form.rank != 1)
    return false;
  const Handle user(H5Tget_member_type(form.type, 0), H5Tclose);
  const Handle dimension(H5Tget_member_type(form.type, 1), H5Tclose);
  return is_object_reference(user.get()) && H5Tget_class(dimension.get()) == H5T_INTEGER;
}

/// Other programs have classes of their own, such as TABLE or IMAGE.
bool is_class(const Form& form) { return H5Tget_class(form.type) == H5T_STRING && form.values == 1; }

bool is_name(const Form& form) { return is_fixed_text(form.type) && form.values == 1; }

bool is_list_of_labels(const Form& form) {
  return H5Tis_variable_str(form.type) > 0 && form.rank == 1 && form.values == form.scaled_rank;
}

struct ScaleAttribute {
  const char* name;
  bool (*is_right)(const Form&);
  const char* form;
  bool of_classes = false;  ///< means something only in a dataset with a CLASS
};
constexpr std::array<ScaleAttribute, 5> kAttributes = {{
    {"CLASS", is_class, "one text"},
    {"NAME", is_name, "one text of fixed length", true},
    {"REFERENCE_LIST", is_list_of_users, "a list of references and dimensions"},
    {"DIMENSION_LIST", is_list_of_references, "a list of references for each dimension"},
    {"DIMENSION_LABELS", is_list_of_labels, "a text of variable length for each dimension"},
}};

int rank_of(hid_t space) { return H5Sget_simple_extent_ndims(space); }

bool is_right(hid_t dataset, const ScaleAttribute& attribute) {
  if (H5Aexists(dataset, attribute.name) == 0) return true;
  const Handle opened(H5Aopen(dataset, attribute.name, H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(opened.get()), H5Tclose);
  const Handle space(H5Aget_space(opened.get()), H5Sclose);
  const Handle scaled(H5Dget_space(dataset), H5Sclose);
  return space && attribute.is_right({type.get(), rank_of(space.get()),
                                      H5Sget_simple_extent_npoints(space.get()), rank_of(scaled.get())});
}

}  // namespace

std::optional<std::string> scale_fault(hid_t dataset) {
  for (const ScaleAttribute& attribute : kAttributes) {
    if (attribute.of_classes && H5Aexists(dataset, "CLASS") == 0) continue;
    if (!is_right(dataset, attribute)) return std::string(attribute.name) + " is not " + attribute.form;
  }
  return std::nullopt;
}

}  // namespace landfall::h5
