# frozen_string_literal: true

require_relative "driver"

# The outcome of a test.
class VerdictsTest < HostTest
  TEAR_DOWN = "  def tear_down = report(\"torn down\")\n"

  def test_a_pass_goes_through_all_steps
    result, host, status, = run_body('report("hello"); check(1 == 1, "one is one")', TEAR_DOWN)
    assert_equal({ "outcome" => "passed" }, result)
    assert_equal [%w[report hello], ["check", "one is one"], ["report", "torn down"]], host.texts
    assert_equal(%w[setup run tear-down], host.of("phase").map { |phase| phase["phase"] })
    assert_predicate status, :success?
  end

  ENDS = {
    'check(false, "closed")' => ["failure", "closed", true],
    'check(nil, "closed")' => ["failure", "closed", true],
    'require(nil, "calibrated")' => ["failure", "calibrated", false],
    'require_critical(false, "stop pressed")' => ["failure", "stop pressed", false],
    'fail("50% too fast, %s %d")' => ["failure", "50% too fast, %s %d", false],
    'error("no encoder")' => ["error", "no encoder", false],
    'begin; require(false, "caught"); rescue Exception; end' => ["failure", "caught", true],
    'begin; fail("through"); rescue => problem; report(problem); end' =>
      ["failure", "through", false],
    "wait_until(0.02, \"the door\") { 0.5 > 1 }" =>
      ["failure", "the door: not within 0.02 s (last value: false)", false],
    'Thread.new { fail("in a thread") }.join' => ["failure", "in a thread", false]
  }.freeze

  def test_a_problem_is_reported_and_the_test_torn_down
    ENDS.each do |line, (kind, text, continues)|
      result, host, = run_body("#{line}; report(\"on\"); check(false, \"later\")", TEAR_DOWN)
      assert_equal({ "outcome" => kind == "error" ? "error" : "failed" }, result, line)
      assert_equal [kind, text], host.problem, line
      assert_equal continues, host.texts.include?(%w[report on]), line
      assert_equal ["report", "torn down"], host.texts.last, line
    end
  end

  RAISED = {
    'raise "no bus"' => "RuntimeError: no bus",
    'fail ArgumentError, "no bus"' => "ArgumentError: no bus",
    "throw 42" => "UncaughtThrowError: uncaught throw 42",
    'raise Class.new(Exception) { def self.to_s = "Odd" }, "x"' => "Odd: x",
    "require \"nowhere\"" => "LoadError: cannot load such file -- nowhere",
    "def deeper = deeper\ndeeper" => "SystemStackError: stack level too deep",
    'Thread.new { raise "no bus" }; sleep(0.2)' => "RuntimeError: no bus"
  }.freeze

  def test_an_exception_is_an_error_with_class_text_location_and_backtrace
    RAISED.each do |line, reason|
      result, host, = run_body(line, TEAR_DOWN)
      assert_equal({ "outcome" => "error" }, result, line)
      message = host.of("message").find { |one| one["kind"] == "error" }
      assert_match(/\A#{Regexp.escape(reason)}\n  from .*plugin\.rb:\d/, message["text"], line)
      assert_equal 4, message["location"]["line"], line
      assert_equal ["report", "torn down"], host.texts.last, line
    end
  end

  def test_a_handled_exception_of_a_thread_is_no_error
    body = "thread = Thread.new { Thread.current.report_on_exception = false; raise \"x\" }\n" \
           "begin; thread.join; rescue RuntimeError => problem; report(problem.message); end"
    result, host, = run_body(body)
    assert_equal({ "outcome" => "passed" }, result)
    assert_equal [%w[report x]], host.texts
  end

  def test_a_problem_in_setup_or_tear_down_does_not_pass
    ["def setup(args) = false", 'def setup(args) = check(false, "plugged in")',
     'def tear_down = require(false, "parked")'].each do |method|
      result, = run_body("", "  #{method}\n")
      refute_equal "passed", result["outcome"], method
    end
  end

  def test_a_measurement_outside_its_limits_does_not_pass
    result, host, = run_body('measure("rate", 87.5, "Hz", low: 95, high: 105); report("on")')
    assert_equal({ "outcome" => "failed" }, result)
    assert_equal [%w[report on]], host.texts
  end

  def test_both_spellings_of_the_tear_down_are_called
    _, host, = run_body("", "  def tearDown = report(\"down\")\n")
    assert_equal [%w[report down]], host.texts
  end

  def test_exit_ends_the_process
    result, _, status, = run_body('check(false, "wrong"); exit(0)')
    assert_nil result
    assert_equal 0, status.exitstatus
  end
end
