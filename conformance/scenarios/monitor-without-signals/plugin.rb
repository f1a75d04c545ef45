require "rtf"

class Monitored < RTF::TestCase
  def run
    monitor("always(level < 2m)")
  end
end
