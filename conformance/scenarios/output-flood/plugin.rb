require "rtf"

class OutputFlood < RTF::TestCase
  def run
    1_000_000.times { |number| puts "flood line #{number}" }
  end
end
