"""The rules of RS274 that surprise, as the conformance corpus tells them, and the tests that hold them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

FILES = ("test_rules.py", "test_rules_of_blocks.py", "test_rules_of_motion.py")
RULES = {
    "reading: blanks mean nothing, names and letters ignore case": "blanks_mean_nothing_also_inside_numbers_and_names",
    "reading: no exponents, bare points": "numbers_may_begin_or_end_with_a_point_and_have_no_exponent",
    "reading: 252 characters": "a_line_has_252_characters_at_most",
    "reading: comments": "a_semicolon_comments_the_rest_and_comments_do_not_nest",
    "reading: N": "n_comes_first_and_is_never_checked_for_order",
    "reading: words once": "a_word_stands_once_and_so_does_a_modal_group",
    "reading: every word used": "a_word_that_no_code_uses_is_an_error",
    "reading: MSG in place": "a_message_is_printed_in_place_as_it_stands",
    "reading: DEBUG fills in": "debug_formats_what_follows",
    "reading: PRINT fills in": "print_puts_values_in_with_six_decimals",
    "reading: percent and M2": "a_leading_percent_ends_at_the_second_one",
    "reading: behind M30": "what_follows_the_end_is_not_read",
    "order: by the table": "the_order_within_a_block_is_not_that_of_writing",
    "order: F before G20": "f_in_the_block_of_a_unit_change_is_in_the_old_unit",
    "order: stop last": "stops_come_after_the_motion",
    "parameters: after the block": "a_setting_takes_effect_after_its_block",
    "parameters: the later wins": "a_later_setting_of_the_block_wins",
    "parameters: unset": "an_unset_number_is_zero_and_an_unset_name_an_error",
    "parameters: global and local": "global_names_are_seen_everywhere_and_local_ones_in_their_call",
    "parameters: index": "an_index_near_a_whole_number_is_that_number",
    "parameters: machine units": "stored_offsets_are_in_machine_units",
    "parameters: position": "the_position_is_asked_for_in_program_units_and_the_active_frame",
    "parameters: read-only": "positions_and_predefined_names_are_read_only",
    "expressions: left to right, signs, MOD": "power_is_left_associative_and_a_sign_belongs_to_its_number",
    "expressions: binding": "operators_bind_in_five_steps",
    "expressions: EQ": "eq_has_a_tolerance_and_lt_has_none",
    "expressions: rounding": "rounding_functions",
    "expressions: degrees": "angles_are_in_degrees",
    "expressions: parentheses": "parentheses_never_group",
    "offsets: nothing moves": "nothing_moves_when_an_offset_changes",
    "offsets: G92 and G52": "g52_and_g92_share_one_store",
    "offsets: G92.1 to .3": "g92_1_clears_and_g92_2_and_3_suspend_and_resume",
    "offsets: G92 everywhere": "g92_applies_in_every_system",
    "offsets: G92 in the rotation": "g92_lies_inside_the_rotation",
    "offsets: L2, P0": "g10_l2_sets_also_in_g91_and_p0_is_the_active_system",
    "offsets: L20": "g10_l20_makes_the_point_read_as_given_and_refuses_r",
    "offsets: G53 refused": "g53_is_for_straight_moves_in_g90",
    "offsets: G53 one block": "g53_counts_for_its_block_only",
    "offsets: G53 and tool": "machine_coordinates_count_the_tool_offset",
    "offsets: G28 axes": "g28_takes_only_the_named_axes_home",
    "offsets: G28 all": "g28_without_axis_words_takes_all_home_and_home_is_in_axes",
    "tools: T and M6": "t_only_selects_and_m6_keeps_the_length_offset",
    "tools: M6 and spindle": "m6_stops_the_spindle_and_keeps_s",
    "tools: G43 without H": "g43_without_h_takes_the_tool_in_the_spindle",
    "tools: G43.1, G43.2": "g43_1_keeps_the_axes_it_does_not_name_and_g43_2_adds",
    "tools: L1": "g10_l1_is_seen_by_the_next_g43_only",
    "tools: L10, L11": "g10_l10_and_l11_choose_the_length_by_where_the_point_reads",
    "compensation: entry": "compensation_begins_at_right_angles_to_the_programmed_direction",
    "compensation: entry by arc": "an_entry_by_an_arc_ends_radially_beside_its_end",
    "compensation: corners": "compensation_rounds_an_outside_corner_and_trims_an_inside_one",
    "compensation: entry too short": "compensation_entry_must_be_longer_than_the_radius",
    "compensation: does not fit": "what_the_tool_does_not_fit_into_is_refused",
    "compensation: G40": "the_move_after_g40_goes_from_the_offset_point_and_is_no_arc",
    "compensation: normal": "moves_along_the_normal_pass_through_compensation",
    "compensation: refused": "what_is_refused_in_compensation",
    "compensation: D0, no D, G41.1": "d0_leaves_the_path_as_it_is_and_g41_takes_the_tool_in_the_spindle",
    "compensation: planes": "compensation_works_in_g17_and_g18_only",
    "arcs: centres": "centres_are_incremental_unless_g90_1",
    "arcs: G18": "in_g18_the_first_axis_is_z",
    "arcs: full circle": "a_full_circle_needs_no_end_words",
    "arcs: turns": "turns_add_full_circles",
    "arcs: R needs an end": "an_arc_by_radius_needs_another_end",
    "arcs: negative R": "negative_radius_is_the_long_way",
    "arcs: mismatch": "the_two_radii_of_an_arc_may_differ_a_little",
    "arcs: the centre stays": "the_centre_of_an_arc_stays_as_programmed",
    "cycles: sticky words": "words_of_a_cycle_stay_while_it_goes_on_and_another_one_needs_its_own",
    "cycles: G91": "in_g91_r_counts_from_the_start_and_z_from_r",
    "cycles: from below": "first_hole_from_below_rises_straight",
    "cycles: L": "repeats_of_a_cycle_in_g90_stay_at_the_same_place",
    "cycles: G99": "g99_counts_at_the_start",
    "cycles: G98": "g98_returns_to_where_the_chain_began",
    "cycles: slanting": "a_hole_left_at_r_is_left_slanting_up_under_g98",
    "cycles: pecks": "peck_drilling_stops_short_of_the_last_depth",
    "cycles: pecks in inch": "the_peck_stops_a_hundredth_of_an_inch_short_in_inch_too",
    "cycles: tapping": "tapping_feeds_both_ways_and_reverses_the_spindle",
    "cycles: boring": "boring_cycles_stop_orient_and_wait",
    "cycles: path mode": "inside_a_cycle_the_path_is_exact",
    "cycles: between holes": "what_lies_between_holes_does_not_end_the_cycle_but_motion_does",
    "feeds: G93": "inverse_time_needs_f_in_every_feed_block",
    "feeds: G93 and length": "inverse_time_is_resolved_with_the_length_of_the_move",
    "feeds: mode discards F": "changing_the_feed_mode_discards_f",
    "feeds: unit": "the_physical_feed_survives_a_change_of_unit",
    "feeds: rotary": "rotary_moves_take_the_feed_as_degrees_also_in_inch",
    "feeds: mixed": "a_move_of_linear_and_rotary_axes_counts_the_linear_ones_alone",
    "feeds: G95": "feed_per_revolution_needs_a_speed",
    "feeds: G96": "surface_speed_is_metres_or_feet_per_minute_with_a_cap",
    "threads: G33": "a_thread_is_one_move_and_nothing_moves_back",
    "threads: G33.1": "a_rigid_tap_is_one_act_that_ends_where_it_began",
    "threads: G76": "g76_cuts_in_many_lines_of_the_same_pitch",
    "threads: G5": "a_chain_of_g5_goes_on_in_its_direction",
    "threads: G5.1": "spline_polyline_stays_on_the_parabola",
    "threads: G5.2": "g5_2_collects_weighted_points_until_g5_3",
    "threads: plane of splines": "splines_lie_in_the_xy_plane",
    "flow: arguments": "a_call_gives_thirty_arguments_of_which_missing_ones_are_zero",
    "flow: restored": "subroutine_arguments_are_restored",
    "flow: value": "whether_a_value_was_returned_can_be_asked",
    "flow: labels": "labels_are_local_to_a_subroutine_and_may_be_computed",
    "flow: defined later": "a_subroutine_may_be_defined_past_the_end",
    "flow: break, continue": "break_leaves_a_while_and_continue_goes_on",
    "flow: repeat": "break_in_a_repeat_is_refused",
    "flow: not taken": "a_branch_not_taken_is_not_read",
    "flow: M98": "m98_repeats_and_the_two_styles_cannot_call_each_other",
    "flow: M98 shares": "m98_shares_numbers_with_its_caller",
    "others: M70, M72": "m70_saves_modes_with_feed_and_speed_and_m72_restores_them",
    "others: M71, M73": "m71_throws_the_save_away_and_m73_restores_at_the_end_of_the_subroutine",
    "others: polar": "polar_words_count_about_the_programs_origin_in_g17_only",
    "others: polar keeps": "polar_coordinates_keep_what_is_not_named",
    "others: P of two": "g4_and_an_arc_would_both_take_p",
    "others: M2": "the_end_of_a_program_stops_what_turns_and_flows_and_keeps_offsets",
    "others: M66": "waiting_for_an_input_makes_no_event",
}


def _tests() -> set[str]:
    here = Path(__file__).parent
    return {
        name for file in FILES for name in re.findall(r"^def test_(\w+)\(", (here / file).read_text(), re.MULTILINE)
    }


@pytest.mark.parametrize("rule", RULES)
def test_each_rule_has_its_test(rule: str) -> None:
    assert RULES[rule] in _tests()


def test_each_test_stands_for_a_rule() -> None:
    assert _tests() == set(RULES.values())
