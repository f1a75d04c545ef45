require "rtf"

class Critical < RTF::TestCase
  def run
    require_critical(false, "the emergency stop is pressed")
  end
end
