require "rtf"

class FixtureValue < RTF::TestCase
  def run
    values = %w[port model ready limits].map { |name| fixture_value("simulator.#{name}") }
    fail("wrong values: #{values}") unless values == [40_123, "arm", true, [-1.5, 1.5]]
    fail("wrong port in the environment") unless ENV["RTF_FIXTURE_SIMULATOR_PORT"] == "40123"

    report("values read")
  end
end
