

package body Plugin is

   overriding procedure Run (Self : in out Test) is
   begin
      raise Constraint_Error with "42";
   end Run;

end Plugin;
