# frozen_string_literal: true

require_relative "driver"

# Values that fixtures provide, and that tests, hooks and fixtures read.
class FixtureValuesTest < HostTest
  KNOWN = [{ name: "simulator.port", value: 40_123 }, { name: "simulator.model", value: "arm" },
           { name: "simulator.limits", value: [-1.5, 1.5] }].freeze

  def fixture(setup, more = "")
    "require \"rtf\"\nclass Sim < RTF::FixtureManager\n  def setup(_)\n#{setup}\n  end\n" \
      "#{more}end\n"
  end

  def set_up(setup)
    host = self.host
    [host, host.ask("set-up-fixture", plugin(fixture(setup)))["result"]]
  end

  def test_a_fixture_provides_values
    host, result = set_up("provide(:port, 40_123); provide('model', 'Bär \"1\"')
                           provide('ready', true); provide('limits', [-1.5, 1.5])
                           provide('joints', { elbow: [0, nil, :left] }); report('up')")
    assert_equal({ "outcome" => "passed" }, result)
    values = { "port" => 40_123, "model" => "Bär \"1\"", "ready" => true, "limits" => [-1.5, 1.5],
               "joints" => { "elbow" => [0, nil, "left"] } }
    wanted = values.map { |name, value| { "name" => name, "value" => value } }
    assert_equal wanted, host.of("provided")
    assert_equal [%w[report up]], host.texts
  end

  PROBLEMS = {
    "nil" => "nil",
    "Object.new" => "not JSON: Object",
    "[1..2]" => "not JSON: Range",
    "{ low: -1.0 / 0 }" => "not JSON: -inf",
    "[0.0 / 0]" => "not JSON: nan",
    "[].tap { |list| list << list }" => "not JSON: more than 98 levels"
  }.freeze

  def test_a_value_that_is_not_json_is_an_error
    PROBLEMS.each do |value, problem|
      host, result = set_up("provide('port', #{value})\nreport('never')")
      assert_equal({ "outcome" => "error" }, result, value)
      assert_empty host.of("provided"), value
      assert_equal ["error", "TypeError: the value of `port` is #{problem}"], host.problem, value
      assert_equal [4], host.of("message").map { |one| one["location"]["line"] }, value
    end
  end

  def test_the_deepest_value_can_be_sent
    host, result = set_up("provide('deep', 97.times.reduce([1]) { |inner, _| [inner] })")
    assert_equal({ "outcome" => "passed" }, result)
    assert_equal [1], host.of("provided").first["value"].flatten
  end

  def test_a_forked_child_provides_no_values
    host, result = set_up("child = fork { provide('port', 1); report('in the child'); exit!(0) }
                           Process.wait(child); provide('port', 2)")
    assert_equal({ "outcome" => "passed" }, result)
    assert_equal [["report", "in the child"]], host.texts
    assert_equal [{ "name" => "port", "value" => 2 }], host.of("provided")
  end

  def test_a_test_reads_values_in_each_step
    more = "def setup(_) = report(fixture_value('simulator.port') + 1)
            def tear_down = report(fixture_value('simulator.limits').first)\n"
    result, host, = run_plugin(arm("report(fixture_value(:'simulator.model'))", more),
                               fixture_values: KNOWN)
    assert_equal({ "outcome" => "passed" }, result)
    assert_equal [%w[report 40124], %w[report arm], ["report", "-1.5"]], host.texts
  end

  def test_an_unknown_value_is_an_error_that_lists_the_known_ones
    body = arm("fixture_value('simulator.speed')\nreport('never')")
    problem = 'there is no fixture value "simulator.speed"; there are '
    result, host, = run_plugin(body, fixture_values: KNOWN)
    assert_equal({ "outcome" => "error" }, result)
    known = "simulator.port, simulator.model, simulator.limits"
    assert_equal [["error", problem + known]], host.texts
    assert_equal 4, host.of("message").first["location"]["line"]
    assert_equal [["error", "#{problem}none"]], run_plugin(body)[1].texts
  end

  def test_a_fixture_reads_the_values_of_others_in_each_step
    step = "report(fixture_value('simulator.port'))"
    more = "def check = #{step}\ndef tear_down = #{step}\n"
    host = self.host
    host.ask("set-up-fixture", plugin(fixture(step, more), fixture_values: KNOWN))
    host.ask("check-fixture", {})
    host.ask("tear-down-fixture", {})
    assert_equal [%w[report 40123]] * 3, host.texts
  end

  def test_wrong_values_in_a_request_are_refused
    [{ port: 1 }, ["port"], [{ value: 1 }], [{ name: "a.b" }],
     [{ name: "a.b", value: nil }]].each do |wrong|
      answer = host.ask("run-test", plugin(arm("nil"), fixture_values: wrong))
      assert_equal(-32_602, answer["error"]["code"], wrong.inspect)
    end
  end
end
