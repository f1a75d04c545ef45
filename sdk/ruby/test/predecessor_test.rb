# frozen_string_literal: true

require_relative "driver"

# Tests that were written for robot-testing-framework 1.x and 2.x.
class PredecessorTest < HostTest
  # Without `require "rtf"`: they did not know it.
  def old(run, more = "")
    "class TestCase\n  def run\n#{run}\n  end\n#{more}end\n"
  end

  def test_only_run_is_needed_and_each_name_of_the_module_works
    ["RobotTestingFramework::", "RobotTestingFramework.", "RTF::", "RTF.",
     "robottestingframework::"].each do |prefix|
      body = "#{prefix}testCheck(5 > 3, \"more\")\n#{prefix}assertFail(\"100% wrong\")"
      result, host, = run_plugin(old(body))
      assert_equal [%w[check more], ["failure", "100% wrong"]], host.texts, prefix
      assert_equal({ "outcome" => "failed" }, result, prefix)
      assert_equal([3, 4], host.of("message").map { |message| message["location"]["line"] })
    end
  end

  def test_setup_gets_one_string_and_has_to_return_something_true
    { "param" => nil, "1" => nil, "false" => "setup returned false",
      "nil" => "setup returned nothing, it has to return true" }.each do |returned, reason|
      setup = "  def setup(param)\n    RTF::testReport(param)\n    #{returned}\n  end\n"
      result, host, = run_plugin(old("", setup))
      assert_equal [reason], [result["reason"] || host.problem.last], returned
      assert_equal ["report", "--rate 100"], host.texts.first
    end
  end

  def test_a_test_case_that_derives_from_the_sdk_is_no_test_of_the_predecessor
    body = "require \"rtf\"\nclass TestCase < RTF::TestCase\n  def run = report(param)\nend\n"
    assert_equal [["report", "--rate 100"]], run_plugin(body)[1].texts
  end

  def test_two_of_them_in_one_host_are_two
    host = self.host
    down = "  def tearDown = RTF::testReport(\"down\")\n"
    host.ask("run-test", plugin(old("RTF::testReport(\"a\")", down), name: "a.rb", is_last: false))
    host.ask("run-test", plugin(old("RTF::testReport(\"b\")"), name: "b.rb"))
    assert_equal %w[a down b], host.texts.map(&:last)
  end
end
