# frozen_string_literal: true

require_relative "driver"

# Tests and cases that skip themselves.
class SkipTest < HostTest
  TEAR_DOWN = "  def tear_down = report(\"torn down\")\n"

  def test_a_case_skips_itself
    result, host, = run_body(<<~RUBY)
      self.case("gripper") { skip("no gripper is mounted") }
      self.case("arm") { nil }
    RUBY
    skipped = { "case" => 1, "outcome" => "skipped", "reason" => "no gripper is mounted" }
    assert_equal [skipped, { "case" => 2 }], host.of("case-finished")
    assert_equal({ "outcome" => "passed" }, result)
  end

  def test_a_test_skips_itself_in_run
    result, host, status, = run_body('skip("no camera"); report("after")', TEAR_DOWN)
    assert_equal({ "outcome" => "skipped", "reason" => "no camera" }, result)
    assert_equal [["report", "torn down"]], host.texts
    assert_predicate status, :success?
  end

  def test_a_test_skips_itself_in_setup
    setup = "  def setup(_args) = skip(\"no robot\")\n"
    result, host, = run_body('report("never")', setup + TEAR_DOWN)
    assert_equal({ "outcome" => "skipped", "reason" => "no robot" }, result)
    assert_equal(%w[setup tear-down], host.of("phase").map { |phase| phase["phase"] })
  end

  def test_a_failure_has_precedence_over_a_skip
    failed = { "outcome" => "failed" }
    assert_equal failed, run_body('check(false, "power"); skip("no camera")').first
    more = "  def tear_down = check(false, \"power\")\n"
    assert_equal failed, run_body('skip("no camera")', more).first
  end

  LATE = { 'skip("late")' => "`skip` is allowed in `setup` and `run` only",
           'plan_cases(["late"])' => "cases are planned in `setup` and `run` only" }.freeze

  def test_skips_and_plans_in_tear_down_are_errors
    LATE.each do |line, text|
      result, host, = run_body("nil", "  def tear_down = #{line}\n")
      assert_equal [{ "outcome" => "error" }, [["error", text]]], [result, host.texts]
    end
  end
end
