# frozen_string_literal: true

require_relative "driver"

# Selected cases, and the values of a matrix.
class CaseSelectionTest < HostTest
  SELECTED = <<~RUBY
    self.case("Arm") do
      self.case("joint 1") { nil }
      self.case("joint 2") { nil }
    end
    %w[left right].each { |side| self.case(side) { self.case("inner") { nil } } }
  RUBY

  SELECTIONS = {
    [] => ["Arm", "joint 1", "joint 2", "left", "inner", "right", "inner"],
    [{ equals: "Arm" }] => ["Arm", "joint 1", "joint 2"],
    [{ equals: "Arm/joint 2" }] => ["Arm", "joint 2"],
    [{ equals: "Ar" }] => [],
    [{ contains: "ight" }] => %w[right inner],
    [{ contains: "joint" }] => [],
    [{ equals: "left" }, { contains: "1" }] => %w[left inner]
  }.freeze

  def test_only_selected_cases_run
    SELECTIONS.each do |cases, names|
      _, host, = run_plugin(arm(SELECTED), cases: cases)
      assert_equal names, host.of("case-started").map { |one| one["name"] }, cases.inspect
    end
  end

  def test_only_selected_cases_are_planned
    body = arm("plan_cases(%w[a b]); plan_cases([:c])")
    planned = [{ "names" => %w[a b] }, { "names" => %w[c] }]
    assert_equal planned, run_plugin(body)[1].of("cases-planned")
    selected = run_plugin(body, cases: [{ equals: "b/inner" }])[1].of("cases-planned")
    assert_equal [{ "names" => %w[b] }], selected
  end

  def test_a_test_has_the_values_of_its_matrix
    body = 'report(parameter(:side)); report(parameters["joint"]); parameter("speed")'
    values = [{ name: "joint", value: "0" }, { name: "side", value: "left" }]
    text = 'there is no parameter "speed"; this test has joint, side'
    _, host, = run_plugin(arm(body), parameters: values)
    assert_equal [%w[report left], %w[report 0], ["error", text]], host.texts
    text = 'there is no parameter "speed"; this test has none'
    assert_equal [["error", text]], run_body('parameter("speed")')[1].texts
  end

  def test_wrong_parameters_of_a_request_are_refused
    [{ cases: [{ matches: "a" }] }, { parameters: { joint: "0" } }].each do |wrong|
      assert_equal(-32_602, host.ask("run-test", plugin(arm("nil"), **wrong))["error"]["code"])
    end
  end
end
