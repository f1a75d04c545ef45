# frozen_string_literal: true

# Write tests and fixtures for the Robot Testing Framework in Ruby.
#
# A plug-in is a file with one class that derives from RTF::TestCase or from
# RTF::FixtureManager:
#
#     require "rtf"
#
#     class Encoders < RTF::TestCase
#       def run
#         check_near(arm.position(3), 0.5, 0.01, "joint 3")
#       end
#     end
#
# It is cheap to require and does not change the process; the connection to the
# runner is in rtf/host.
module RTF
end

require "rtf/version"
require "rtf/test_case"
require "rtf/fixture_manager"
