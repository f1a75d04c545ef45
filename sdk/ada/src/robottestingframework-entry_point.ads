--  SPDX-License-Identifier: Apache-2.0
--  What the host finds in the shared library: rtf_plugin and its table. No
--  exception leaves its functions.

package RobotTestingFramework.Entry_Point is
   pragma Elaborate_Body;

end RobotTestingFramework.Entry_Point;
