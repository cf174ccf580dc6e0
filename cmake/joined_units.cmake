# Files of one folder are compiled several at a time (CMake's unity builds): what a file costs is
# mostly the templates that its neighbours instantiate too. Names in unnamed namespaces are
# therefore unique within a folder. -D STILLBASE_JOINED_UNITS=OFF compiles each file alone.
option(STILLBASE_JOINED_UNITS "Compile several files of a folder as one unit" ON)

# Files that take long alone, that a test replaces, or that repeat a name of a neighbour.
set(STILLBASE_OWN_UNITS
  audit/proof_test collision/scene cli/inputs_test cli/limits_test cli/refusal_test cli/schema_test
  formulation/exact_derivatives_test formulation/formulation_test io/post_impact_section_test
  robot/urdf_refusal_test simulation/simulate_test
  core/linear_algebra dynamics/double encounter/encounter encounter/target_motion
  formulation/capture_model_tangent
  proof/articulated_forms proof/bound proof/case_rows proof/dynamics_over_boxes proof/enclose
  proof/minimum proof/spin proof/variable_encounter
  reference/reference report/embedded_page robot/convex_hull robot/scene_file target/prediction
  target/target verification/recomputation
  verification/trials)

# join_units(TARGET N): units of up to N neighbouring files.
function(join_units target files_per_unit)
  get_target_property(sources ${target} SOURCES)
  list(SORT sources)
  foreach(source IN LISTS sources)
    get_filename_component(folder ${source} DIRECTORY)
    get_filename_component(room ${folder} NAME)
    get_filename_component(name ${source} NAME_WE)
    if("${room}/${name}" IN_LIST STILLBASE_OWN_UNITS)
      continue()
    endif()
    if(NOT DEFINED number_${room})
      set(number_${room} 0)
    endif()
    math(EXPR unit "${number_${room}} / ${files_per_unit}")
    math(EXPR number_${room} "${number_${room}} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${room}_${unit})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${STILLBASE_JOINED_UNITS}
    UNITY_BUILD_MODE GROUP)
endfunction()
